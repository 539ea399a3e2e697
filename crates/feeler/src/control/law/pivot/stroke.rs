//! Record of one finger's MOVE, and the radius and compliance of its next stroke computed from it.

use super::PivotConfig;
use super::circle::Circle;
use crate::control::feeler_shape::Stiffness;
use glam::DVec2;

/// Angle about the pivot that one sector of a stroke covers, rad.
const SECTOR: f64 = 0.0125;
/// Sectors of a stroke; the last one covers whatever comes after it, too.
const SECTORS: usize = 64;
/// Least number of sectors of a stroke that is long enough to learn from.
const FEWEST_SECTORS: usize = 5;
/// A finger that felt less than its target advances by the missing force over the stiffness, divided by this: friction
/// tilts feelers, so that force rises faster with depth than their stiffness says.
const ADVANCE: f64 = 2.0;
/// Relative variation of the grasp force that a finger tolerates without leaving the circle.
const LEVEL_GRIP: f64 = 0.1;
/// Number of elements that share the load where a finger leaves the circle to keep its grasp force level.
const SHARING: f64 = 2.0;
/// Largest radial compliance, relative to that of one feeler.
const MOST_SOFTNESS: f64 = 0.5;
/// Elements that share a load are counted as grasp force over the largest force, but no less than this, N.
const LEAST_FORCE: f64 = 0.05;
/// Part of the travel over which a path is compared with the planned line.
const WINDOW: (f64, f64) = (0.25, 0.98);

/// Means and maxima over one sector.
#[derive(Debug, Clone, Copy, Default)]
struct Sector {
    samples: f64,
    /// Mean distance of the dome's centre from the pivot, m.
    radius: f64,
    /// Mean grasp force, N.
    grip: f64,
    /// Mean and maximum of the largest element force, N.
    mean_force: f64,
    most_force: f64,
}

/// Radius and forces of one finger's MOVE, in sectors of the angle about the pivot.
#[derive(Debug, Clone)]
pub(super) struct StrokeRecord {
    sectors: [Sector; SECTORS],
}

/// Parameters of a finger's next stroke.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lesson {
    /// Distance of the dome's centre from the pivot, m.
    pub radius: f64,
    /// Expected mean of the grasp force, N.
    pub mean_grip: f64,
    /// Radial compliance: the finger gives way by this times the excess of grasp force, m/N.
    pub compliance: f64,
}

/// Where a MOVE began and ended, m, x and y in W, and its planned direction.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Course {
    pub start: DVec2,
    pub end: DVec2,
    pub direction: DVec2,
}

impl StrokeRecord {
    /// A MOVE that has not begun.
    pub fn new() -> Self {
        Self {
            sectors: [Sector::default(); SECTORS],
        }
    }

    /// Adds a control step: the angle swept since MOVE began, rad; the distance from the pivot, m; the grasp force and the
    /// largest element force, N.
    pub fn add(&mut self, swept: f64, radius: f64, grip: f64, force: f64) {
        let index = ((swept / SECTOR).max(0.0) as usize).min(SECTORS - 1);
        let sector = &mut self.sectors[index];
        sector.samples += 1.0;
        sector.radius += (radius - sector.radius) / sector.samples;
        sector.grip += (grip - sector.grip) / sector.samples;
        sector.mean_force += (force - sector.mean_force) / sector.samples;
        sector.most_force = sector.most_force.max(force);
    }

    fn sectors(&self) -> impl Iterator<Item = &Sector> {
        self.sectors.iter().filter(|sector| sector.samples > 0.0)
    }

    /// Radius and grasp force of the next stroke for a largest element force of `target` (N); `None` if this stroke was too
    /// short.
    pub fn lesson(&self, target: f64, stiffness: Stiffness) -> Option<Lesson> {
        if self.sectors().count() < FEWEST_SECTORS {
            return None;
        }
        let allowed = |sector: &Sector| {
            let excess = sector.most_force - target;
            let slope = stiffness.normal * if excess > 0.0 { 1.0 } else { ADVANCE };
            sector.radius + excess / slope
        };
        let radius = self.sectors().map(allowed).fold(0.0, f64::max);
        let (mean_grip, _) = self.grip_at(radius, stiffness);
        Some(Lesson {
            radius,
            mean_grip,
            compliance: 0.0,
        })
    }

    /// Radial compliance that levels the grasp force on a circle of `radius` (m), m/N, limited by the path tolerance relative to
    /// `line_deviation` (m), the standard deviation of the radius on the planned line.
    pub fn compliance(
        &self,
        radius: f64,
        stiffness: Stiffness,
        config: &PivotConfig,
        line_deviation: f64,
    ) -> f64 {
        let (mean, deviation) = self.grip_at(radius, stiffness);
        let variation = deviation / mean.max(LEAST_FORCE);
        let wanted = ((variation / LEVEL_GRIP - 1.0) / SHARING).clamp(0.0, MOST_SOFTNESS);
        let most = config.path_tolerance * line_deviation / deviation.max(1e-3);
        (wanted / stiffness.normal).min(most)
    }

    /// Mean and standard deviation of the grasp force that is expected on a circle of `radius` (m), N.
    fn grip_at(&self, radius: f64, stiffness: Stiffness) -> (f64, f64) {
        let grip = |sector: &Sector| {
            let deeper = sector.radius - radius;
            let sharing = sector.grip / sector.mean_force.max(LEAST_FORCE);
            (sector.grip + sharing * stiffness.normal * deeper).max(0.0)
        };
        let samples: f64 = self.sectors().map(|sector| sector.samples).sum();
        let mean = self.sectors().map(|s| s.samples * grip(s)).sum::<f64>() / samples;
        let square = |sector: &Sector| sector.samples * (grip(sector) - mean).powi(2);
        let variance = self.sectors().map(square).sum::<f64>() / samples;
        (mean, variance.sqrt())
    }
}

impl Course {
    /// Standard deviation of the distance from the pivot that the planned straight line would have, m: with
    /// `R ≈ R_0 + u²/2R` at the distance u along the line from the foot of the pivot's perpendicular.
    pub fn line_deviation(&self, circle: &Circle) -> f64 {
        let along = |point: DVec2| (point - circle.centre).dot(self.direction);
        let (first, last) = (along(self.start), along(self.end));
        let [a, b] = [WINDOW.0, WINDOW.1].map(|part| first + part * (last - first));
        let mean_power = |n: i32| (b.powi(n + 1) - a.powi(n + 1)) / (f64::from(n + 1) * (b - a));
        let variance = mean_power(4) - mean_power(2).powi(2);
        let deviation = variance.max(0.0).sqrt() / (2.0 * self.start.distance(circle.centre));
        if deviation.is_finite() {
            deviation
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STIFFNESS: Stiffness = Stiffness {
        normal: 200.0,
        shear: 100.0,
    };

    /// A stroke at a radius of 32 mm in which the largest element force is `force(k)` in sector `k` of 20.
    fn record(force: impl Fn(usize) -> f64) -> StrokeRecord {
        let mut record = StrokeRecord::new();
        for step in 0..100 {
            let force = force(step / 5);
            record.add(
                SECTOR * (step as f64 + 0.5) / 5.0,
                0.032,
                2.0 * force,
                force,
            );
        }
        record
    }

    #[test]
    fn the_hardest_pressed_sector_decides_the_radius() {
        let mut forces = record(|k| if k == 7 { 0.5 } else { 0.3 });
        let lesson = forces.lesson(0.4, STIFFNESS).expect("a lesson");
        assert!(
            (lesson.radius - (0.032 + 0.1 / 200.0)).abs() < 1e-12,
            "{lesson:?}"
        );
        // Too little force: half of what the stiffness says.
        forces = record(|_| 0.3);
        let lesson = forces.lesson(0.4, STIFFNESS).expect("a lesson");
        assert!(
            (lesson.radius - (0.032 - 0.05 / 200.0)).abs() < 1e-12,
            "{lesson:?}"
        );
        // Two elements share the load: 100 mN more on the largest are 200 mN more grip; here half of that.
        assert!((lesson.mean_grip - 0.7).abs() < 1e-12, "{lesson:?}");
    }

    #[test]
    fn a_short_stroke_teaches_nothing() {
        let mut short = StrokeRecord::new();
        short.add(0.0, 0.032, 1.0, 0.5);
        assert_eq!(short.lesson(0.4, STIFFNESS), None);
    }

    #[test]
    fn only_an_uneven_grip_makes_the_finger_compliant() {
        let config = PivotConfig::default();
        let compliance =
            |record: &StrokeRecord, line| record.compliance(0.032, STIFFNESS, &config, line);
        assert_eq!(compliance(&record(|_| 0.4), 1.0), 0.0);
        let uneven = record(|k| if k % 2 == 0 { 0.3 } else { 0.5 });
        // Standard deviation 0.2 N of a mean of 0.8 N: 2.5 times what is level.
        assert!((compliance(&uneven, 1.0) - 0.5 / 200.0).abs() < 1e-12);
        // The path may leave the circle by a quarter of the line's 0.1 mm.
        assert!((compliance(&uneven, 1e-4) - 0.25 * 1e-4 / 0.2).abs() < 1e-12);
    }

    /// Against the distance of points on the line, one by one.
    #[test]
    fn the_planned_line_has_the_deviation_of_its_points() {
        let circle = Circle {
            centre: DVec2::new(0.001, 0.002),
            radius: 0.016,
        };
        let course = Course {
            start: DVec2::new(-0.033, 0.004),
            end: DVec2::new(-0.0325, -0.0045),
            direction: DVec2::NEG_Y,
        };
        // The line passes through where the window begins; its distance from the pivot there is that of the circle.
        let radii: Vec<f64> = (0..=1000)
            .map(|k| {
                let part = WINDOW.0 + (WINDOW.1 - WINDOW.0) * f64::from(k) / 1000.0;
                let point = course.start + 0.0085 * part * course.direction;
                point.distance(circle.centre)
            })
            .collect();
        let mean = radii.iter().sum::<f64>() / radii.len() as f64;
        let variance = radii.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / radii.len() as f64;
        // The next term of the root is (u/2R)² of the first: 1 %.
        let found = course.line_deviation(&circle);
        assert!(
            (found / variance.sqrt() - 1.0).abs() < 0.01,
            "{found} {}",
            variance.sqrt()
        );
    }
}
