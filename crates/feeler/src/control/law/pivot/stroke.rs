//! Record of one finger's stroke (phase MOVE), from which the radius and compliance of its next stroke are computed.

use crate::control::feeler_shape::Stiffness;

/// Angle about the pivot covered by one sector of a stroke (rad).
const SECTOR: f64 = 0.0125;
/// Number of sectors of a stroke; the last one includes everything after it.
const SECTORS: usize = 64;
/// Minimum number of sectors for a stroke to be evaluated.
const FEWEST_SECTORS: usize = 5;
/// Divisor of the inward correction of a finger below its target force (missing force divided by stiffness): friction
/// tilts the feelers, so that force rises faster with depth than their stiffness predicts.
const ADVANCE: f64 = 1.5;
/// Tolerance of the grasp force: standard deviation divided by the mean.
const GRIP_TOLERANCE: f64 = 0.15;
/// Force variation and path deviation, relative to their tolerances, below which no more compliance is needed.
const GOOD_ENOUGH: f64 = 0.6;
/// Step between candidate radial compliances, relative to the compliance of one feeler.
const COMPLIANCE_STEP: f64 = 0.05;
/// Number of steps between candidate radial compliances.
const COMPLIANCE_STEPS: u32 = 10;
/// Number of fixed-point iterations for the path of a compliant finger.
const ITERATIONS: u32 = 8;
/// Fraction of the samples at the start of a stroke that is excluded from the variation, because forces still build up.
const BUILD_UP: f64 = 0.2;
/// Lower bound of forces that are used as divisors or references (N).
const MIN_FORCE: f64 = 0.05;
/// Tangential force on a fingertip, relative to its grasp force, above which the object counts as resisting.
const RESISTS: f64 = 0.5;

/// Means and maxima over one sector.
#[derive(Debug, Clone, Copy, Default)]
struct Sector {
    samples: f64,
    /// Mean distance of the dome's centre from the pivot (m).
    radius: f64,
    /// Mean grasp force (N).
    grip: f64,
    /// Mean of the largest element force in the sector (N).
    mean_force: f64,
    /// Maximum of the largest element force in the sector (N).
    most_force: f64,
}

/// Data of one control step of a stroke.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    /// Angle swept about the pivot since MOVE began (rad).
    pub swept: f64,
    /// Distance of the dome's centre from the pivot (m).
    pub radius: f64,
    /// Grasp force (N).
    pub grip: f64,
    /// Largest element force (N).
    pub force: f64,
    /// Tangential force on the fingertip, opposing its motion (N).
    pub tangential: f64,
}

/// Radius and forces of one finger during a stroke, by sectors of the angle about the pivot.
#[derive(Debug, Clone)]
pub(super) struct StrokeRecord {
    sectors: [Sector; SECTORS],
    resisted: bool,
}

/// Parameters of a finger's next stroke.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct StrokeParameters {
    /// Distance of the dome's centre from the pivot (m).
    pub radius: f64,
    /// Expected mean grasp force (N).
    pub mean_grip: f64,
    /// Radial compliance (m/N): the finger retreats by this value times the grasp force in excess of its mean.
    pub compliance: f64,
}

/// Predicted results of a stroke with a given compliance.
#[derive(Debug, Clone, Copy)]
struct Forecast {
    lesson: StrokeParameters,
    /// Standard deviation of the radius (m).
    path_deviation: f64,
    /// Standard deviation of the grasp force divided by its mean.
    grip_variation: f64,
}

impl StrokeRecord {
    /// Creates an empty record.
    pub fn new() -> Self {
        Self {
            sectors: [Sector::default(); SECTORS],
            resisted: false,
        }
    }

    /// Adds a control step.
    pub fn add(&mut self, sample: Sample) {
        let index = ((sample.swept / SECTOR).max(0.0) as usize).min(SECTORS - 1);
        let sector = &mut self.sectors[index];
        sector.samples += 1.0;
        sector.radius += (sample.radius - sector.radius) / sector.samples;
        sector.grip += (sample.grip - sector.grip) / sector.samples;
        sector.mean_force += (sample.force - sector.mean_force) / sector.samples;
        sector.most_force = sector.most_force.max(sample.force);
        self.resisted |= sample.tangential > RESISTS * sample.grip.max(MIN_FORCE);
    }

    /// Returns whether the object resisted being turned in some part of the stroke.
    pub fn resisted(&self) -> bool {
        self.resisted
    }

    /// Computes the parameters of the next stroke from this one; `None` if this one was too short. The largest element
    /// force of the next stroke is expected to be `target` (N). `path_tolerance` (m) is the tolerated standard
    /// deviation of the radius.
    ///
    /// A stiff finger follows the circle, and its grasp force varies; a compliant one leaves the circle to keep the
    /// force constant. The chosen compliance minimises the larger of both deviations, relative to their tolerances.
    pub fn lesson(
        &self,
        target: f64,
        stiffness: Stiffness,
        path_tolerance: f64,
    ) -> Option<StrokeParameters> {
        if self.sectors().count() < FEWEST_SECTORS {
            return None;
        }
        let forecasts = (0..=COMPLIANCE_STEPS).map(|step| {
            let relative = COMPLIANCE_STEP * f64::from(step);
            self.forecast(target, stiffness, relative / stiffness.normal)
        });
        let cost = |forecast: &Forecast| {
            let path = forecast.path_deviation / path_tolerance.max(1e-9);
            let grip = forecast.grip_variation / GRIP_TOLERANCE;
            path.max(grip).max(GOOD_ENOUGH)
        };
        // The first of equals, which is the stiffest.
        let best = forecasts.min_by(|a, b| cost(a).total_cmp(&cost(b)))?;
        Some(best.lesson)
    }

    /// Predicts the results of a stroke with a `compliance` (m/N) whose largest element force is `target` (N). Every
    /// sector is modelled as a spring at its recorded radius and force.
    fn forecast(&self, target: f64, stiffness: Stiffness, compliance: f64) -> Forecast {
        let allowed = |sector: &Sector| {
            let excess = sector.most_force - target;
            let slope = stiffness.normal * if excess > 0.0 { 1.0 } else { ADVANCE };
            sector.radius + excess / slope
        };
        let grip = |sector: &Sector, radius: f64, compliance: f64, mean: f64| {
            let sharing = sector.grip / sector.mean_force.max(MIN_FORCE);
            let spring = sharing * stiffness.normal;
            let rigid = (sector.grip + spring * (sector.radius - radius)).max(0.0);
            (rigid + spring * compliance * mean) / (1.0 + spring * compliance)
        };
        let mut radius = self.sectors().map(allowed).fold(0.0, f64::max);
        let (mut mean, mut deviation) = self.moments(|sector| grip(sector, radius, 0.0, 0.0));
        for _ in 0..ITERATIONS {
            let centre = |sector: &Sector| {
                allowed(sector) - compliance * (grip(sector, radius, compliance, mean) - mean)
            };
            let needed = self.sectors().map(centre).fold(0.0, f64::max);
            radius += 0.5 * (needed - radius);
            (mean, deviation) = self.moments(|sector| grip(sector, radius, compliance, mean));
        }
        Forecast {
            lesson: StrokeParameters {
                radius,
                mean_grip: mean,
                compliance,
            },
            path_deviation: compliance * deviation,
            grip_variation: deviation / mean.max(MIN_FORCE),
        }
    }

    /// Mean and standard deviation of `value` over the samples after the initial build-up of forces.
    fn moments(&self, value: impl Fn(&Sector) -> f64) -> (f64, f64) {
        let all: f64 = self.sectors().map(|sector| sector.samples).sum();
        let (mut passed, mut samples, mut sum, mut square) = (0.0, 0.0, 0.0, 0.0);
        for sector in self.sectors() {
            passed += sector.samples;
            if passed > BUILD_UP * all {
                let value = value(sector);
                samples += sector.samples;
                sum += sector.samples * value;
                square += sector.samples * value * value;
            }
        }
        let mean = sum / samples;
        (mean, (square / samples - mean * mean).max(0.0).sqrt())
    }

    fn sectors(&self) -> impl Iterator<Item = &Sector> {
        self.sectors.iter().filter(|sector| sector.samples > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STIFFNESS: Stiffness = Stiffness {
        normal: 200.0,
        shear: 100.0,
    };

    /// A stroke at a radius of 32 mm whose largest element force is `force(k)` in sector `k` of 20.
    fn record(force: impl Fn(usize) -> f64) -> StrokeRecord {
        let mut record = StrokeRecord::new();
        for step in 0..100 {
            let force = force(step / 5);
            record.add(Sample {
                swept: SECTOR * (step as f64 + 0.5) / 5.0,
                radius: 0.032,
                grip: 2.0 * force,
                force,
                tangential: 0.1,
            });
        }
        record
    }

    /// Parameters learned from `record` if the finger must stay on the circle.
    fn on_circle(record: &StrokeRecord, target: f64) -> StrokeParameters {
        record.lesson(target, STIFFNESS, 0.0).expect("a lesson")
    }

    #[test]
    fn the_hardest_pressed_sector_decides_the_radius() {
        let lesson = on_circle(&record(|k| if k == 7 { 0.5 } else { 0.3 }), 0.4);
        let expected = 0.032 + 0.1 / 200.0;
        assert!((lesson.radius - expected).abs() < 1e-12, "{lesson:?}");
        // Too little force: two thirds of the advance that the stiffness predicts.
        let lesson = on_circle(&record(|_| 0.3), 0.4);
        let expected = 0.032 - 0.1 / ADVANCE / 200.0;
        assert!((lesson.radius - expected).abs() < 1e-12, "{lesson:?}");
        // Two elements share the load: 100 mN more on the largest are 200 mN more grip; here two thirds of that.
        let expected = 0.6 + 0.2 / ADVANCE;
        assert!((lesson.mean_grip - expected).abs() < 1e-12, "{lesson:?}");
    }

    #[test]
    fn a_short_stroke_teaches_nothing() {
        let mut short = StrokeRecord::new();
        short.add(Sample {
            swept: 0.0,
            radius: 0.032,
            grip: 1.0,
            force: 0.5,
            tangential: 0.0,
        });
        assert_eq!(short.lesson(0.4, STIFFNESS, 0.0), None);
    }

    #[test]
    fn only_an_uneven_grip_makes_the_finger_compliant() {
        let compliance = |record: &StrokeRecord, tolerance| {
            let lesson = record.lesson(0.6, STIFFNESS, tolerance).expect("a lesson");
            lesson.compliance * STIFFNESS.normal
        };
        assert_eq!(compliance(&record(|_| 0.4), 1.0), 0.0);
        let uneven = record(|k| if k % 2 == 0 { 0.3 } else { 0.5 });
        // The maximum compliance if the path does not matter.
        let most = COMPLIANCE_STEP * f64::from(COMPLIANCE_STEPS);
        assert!((compliance(&uneven, 1.0) - most).abs() < 1e-12);
        // Springs of 400 N/m whose forces vary by ±0.2 N about a mean of about 0.9 N. With a compliance of 0.1/200
        // m/N they vary by ±0.167 N, 1.2 times the tolerance, on a path of ±0.083 mm. A path tolerance of 0.069 mm
        // balances both, to within a step of compliance.
        let balanced = compliance(&uneven, 0.083e-3 / 1.2);
        assert!(
            (balanced - 0.1).abs() < COMPLIANCE_STEP + 1e-9,
            "{balanced}"
        );
    }

    /// Springs of 400 N/m whose forces vary by ±0.1 N on a circle vary by `0.1/(1 + 400 c)` with the compliance c.
    #[test]
    fn a_forecast_is_that_of_springs() {
        let uneven = record(|k| if k % 2 == 0 { 0.3 } else { 0.4 });
        let compliance = 0.25 / 200.0;
        let forecast = uneven.forecast(0.4, STIFFNESS, compliance);
        let deviation = forecast.path_deviation / compliance;
        assert!((deviation - 0.1 / 1.5).abs() < 1e-9, "{deviation}");
    }

    #[test]
    fn an_object_resists_if_the_tangential_force_is_large() {
        let mut loose = record(|_| 0.3);
        assert!(!loose.resisted());
        loose.add(Sample {
            swept: 0.1,
            radius: 0.032,
            grip: 1.0,
            force: 0.5,
            tangential: 0.6,
        });
        assert!(loose.resisted());
    }
}
