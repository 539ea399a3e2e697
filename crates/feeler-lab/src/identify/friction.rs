//! Friction coefficients from the ratio of shear to normal force while a finger slides along the object's axis.

use super::noise::Measured;
use super::pivot::{Circle, pushed_tip};
use super::trace::{FingerTrace, Row};
use feeler::control::Stiffness;
use feeler::control::task::probe::Step;

/// Friction coefficients of one finger's elements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    /// Coefficient while an element sticks.
    pub static_friction: Measured,
    /// Coefficient while an element slips.
    pub kinetic_friction: Measured,
}

/// Threshold at which a decrease of the ratio counts as a slip, in standard deviations of one sample.
const FALL: f64 = 5.0 * std::f64::consts::SQRT_2;
/// Minimum number of samples before and after the first slip.
const MIN_SAMPLES: usize = 8;

/// Ratio of shear to normal force of one sliding element over time.
#[derive(Debug, Clone, Default)]
pub struct Slide {
    /// Times since the beginning of the slide (s).
    pub time: Vec<f64>,
    /// Ratios; negative while the shear force points along the motion.
    pub ratio: Vec<f64>,
    /// Standard deviation of the noise of a ratio.
    pub noise: f64,
    /// Index of the first sample after the first slip.
    pub onset: usize,
}

/// Extracts the slide at each probed place from the trace of a finger, measured by the element with the largest load.
/// Places without a detected slip are omitted. `noise` is the standard deviation of the forces (N).
pub fn slides(
    trace: &FingerTrace,
    circle: &Circle,
    stiffness: Stiffness,
    noise: f64,
) -> Vec<Slide> {
    let places = trace.rows.iter().map(|row| row.place).max().unwrap_or(0);
    (0..=places)
        .filter_map(|place| slide(trace, place, circle, stiffness, noise))
        .collect()
}

fn slide(
    trace: &FingerTrace,
    place: u32,
    circle: &Circle,
    stiffness: Stiffness,
    noise: f64,
) -> Option<Slide> {
    let slides = |row: &Row| row.place == place && row.step == Step::Slide;
    let first = trace.rows.iter().position(slides)?;
    let last = trace.rows.iter().rposition(slides)?;
    let rows = &trace.rows[first..=last];
    let way = (rows[rows.len() - 1].pose.position - rows[0].pose.position).dot(trace.axis);
    let way = way.signum() * trace.axis;
    let load = |element: usize| -> f64 { rows.iter().map(|row| row.forces[element].z).sum() };
    let elements = 0..trace.layout.elements.len();
    let element = elements.max_by(|&a, &b| f64::total_cmp(&load(a), &load(b)))?;
    let mut slide = Slide::default();
    for (index, row) in (first..).zip(rows) {
        let tip = pushed_tip(trace, index, element, stiffness).truncate();
        let outward = (tip - circle.centre()).normalize_or_zero().extend(0.0);
        let force = trace.layout.elements[element].force_on_fingertip(row.forces[element]);
        let force = row.pose.rotation * force;
        let normal = force.dot(outward);
        if normal < 2.0 * noise {
            continue;
        }
        // Friction on the feeler opposes its motion.
        let shear = force - normal * outward;
        let along = -shear.dot(way);
        let across = (shear.length_squared() - along * along).max(0.0);
        let shear = along.signum() * (along * along + across - noise * noise).max(0.0).sqrt();
        slide.time.push(row.time - rows[0].time);
        slide.ratio.push(
            if across.sqrt() > along.abs() {
                along
            } else {
                shear
            } / normal,
        );
        slide.noise += noise * noise * (1.0 + (along / normal).powi(2)) / normal.powi(2);
    }
    slide.noise = (slide.noise / slide.time.len().max(1) as f64).sqrt();
    slide.onset = onset(&slide.ratio)?;
    Some(slide)
}

/// Returns the index of the first sample after the first slip, where a line fitted before it and a constant fitted
/// after it leave the smallest residual. Returns `None` if the `ratio` of shear to normal force never stops rising.
fn onset(ratio: &[f64]) -> Option<usize> {
    // The ratio first decreases while the shear left from pressing relaxes.
    let begin = (0..ratio.len()).min_by(|&a, &b| f64::total_cmp(&ratio[a], &ratio[b]))?;
    let rising = &ratio[begin..];
    let latest = rising.len().checked_sub(MIN_SAMPLES)?;
    let cost = |at: usize| misfit(&rising[..at], true) + misfit(&rising[at..], false);
    let best = (MIN_SAMPLES..=latest).map(|at| (cost(at), at));
    let (_, at) = best.min_by(|a, b| a.0.total_cmp(&b.0))?;
    (at < latest).then_some(begin + at)
}

/// Sum of squared deviations from the mean, or from a fitted line.
fn misfit(values: &[f64], line: bool) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let middle = 0.5 * (count - 1.0);
    let (mut yy, mut xy, mut xx) = (0.0, 0.0, 0.0);
    for (index, value) in values.iter().enumerate() {
        let (x, y) = (index as f64 - middle, value - mean);
        yy += y * y;
        xy += x * y;
        xx += x * x;
    }
    if line { yy - xy * xy / xx } else { yy }
}

/// Estimates both coefficients from the slides of one finger. Returns `None` if the elements never slid.
///
/// A sliding element alternates between sticking and slipping: the ratio rises to the static coefficient and falls to
/// the kinetic one. Both are computed from distinct falls, if there are enough. If noise hides the falls, they are
/// computed from the mean and variance of the ratio, which rises linearly between the two.
pub fn friction(slides: &[Slide]) -> Option<Friction> {
    let falls = by_falls(slides);
    falls.or_else(|| by_spread(slides))
}

fn by_falls(slides: &[Slide]) -> Option<Friction> {
    let (mut before, mut after, mut rise) = (Vec::new(), Vec::new(), Vec::new());
    let mut noise = 0.0_f64;
    for slide in slides {
        noise = noise.max(slide.noise);
        let from = slide.onset.saturating_sub(4);
        for pair in slide.ratio[from..].windows(2) {
            if pair[0] - pair[1] > FALL * slide.noise {
                before.push(pair[0]);
                after.push(pair[1]);
            } else {
                rise.push(pair[1] - pair[0]);
            }
        }
    }
    if before.len() < 3 {
        return None;
    }
    // A slip occurs between two samples: on average, the ratio rises by half a sample's increment before it and after
    // it.
    let rise = mean(&rise);
    let (highest, lowest) = (mean(&before) + 0.5 * rise, mean(&after) - 0.5 * rise);
    if highest - lowest < 2.0 * FALL * noise {
        return None;
    }
    let each = noise.hypot(rise / 12_f64.sqrt());
    let deviation = each / (before.len() as f64).sqrt();
    Some(Friction::new(highest, lowest, deviation))
}

fn by_spread(slides: &[Slide]) -> Option<Friction> {
    let (mut sum, mut squares, mut own, mut count) = (0.0, 0.0, 0.0, 0.0);
    for slide in slides {
        let sliding = &slide.ratio[slide.onset..];
        sum += sliding.iter().sum::<f64>();
        count += sliding.len() as f64;
        own += slide.noise.powi(2) * sliding.len() as f64;
    }
    if count < 2.0 * MIN_SAMPLES as f64 {
        return None;
    }
    let mean = sum / count;
    for slide in slides {
        squares += slide.ratio[slide.onset..]
            .iter()
            .map(|r| (r - mean).powi(2))
            .sum::<f64>();
    }
    let (total, own) = (squares / (count - 1.0), own / count);
    let half = (3.0 * (total - own)).max(0.0).sqrt();
    // The relative standard error of the variance is sqrt(2 / count).
    let variance = total * (2.0 / count).sqrt();
    let spread = (3.0 * variance)
        .sqrt()
        .min(1.5 * variance / half.max(f64::MIN_POSITIVE));
    let deviation = spread.hypot((total / count).sqrt());
    Some(Friction::new(mean + half, mean - half, deviation))
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

impl Friction {
    fn new(highest: f64, lowest: f64, deviation: f64) -> Self {
        let measured = |value| Measured { value, deviation };
        Self {
            static_friction: measured(highest),
            kinetic_friction: measured(lowest),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// A slide whose ratio rises by `rise` per sample to `highest` and then falls to `lowest`.
    fn sawtooth((highest, lowest, rise): (f64, f64, f64), noise: f64) -> Slide {
        let mut ratio = Vec::new();
        let (mut exact, mut seed) = (-0.1, 0.0_f64);
        for _ in 0..300 {
            exact += rise;
            if exact > highest {
                exact = lowest + (exact - highest) % (highest - lowest);
            }
            // Gaussian noise by the Box-Muller transform of a low-discrepancy sequence.
            seed += 1.0;
            let (u, v) = ((0.618_034 * seed).fract(), (0.754_878 * seed).fract());
            let normal = (-2.0 * (1.0 - u).ln()).sqrt() * (TAU * v).cos();
            ratio.push(exact + noise * normal);
        }
        Slide {
            time: (0..300).map(|index| 0.01 * f64::from(index)).collect(),
            onset: onset(&ratio).expect("it slides"),
            ratio,
            noise,
        }
    }

    #[test]
    fn distinct_falls_determine_both_coefficients() {
        let slides = [1.2, 1.21].map(|highest| sawtooth((highest, 0.8, 0.013), 0.002));
        let found = friction(&slides).expect("it slides");
        // A slip occurs anywhere within the rise of one sample.
        assert!(
            (found.static_friction.value - 1.205).abs() < 0.013,
            "{found:?}"
        );
        assert!(
            (found.kinetic_friction.value - 0.8).abs() < 0.013,
            "{found:?}"
        );
    }

    #[test]
    fn the_spread_determines_coefficients_if_noise_hides_falls() {
        let slides = [0.011, 0.013, 0.017].map(|rise| sawtooth((0.9, 0.75, rise), 0.05));
        let found = friction(&slides).expect("it slides");
        let (fixed, sliding) = (found.static_friction, found.kinetic_friction);
        assert!(
            (fixed.value - 0.9).abs() < 3.0 * fixed.deviation,
            "{found:?}"
        );
        assert!(
            (sliding.value - 0.75).abs() < 3.0 * sliding.deviation,
            "{found:?}"
        );
        assert!(fixed.deviation < 0.03, "{found:?}");
    }

    #[test]
    fn a_rising_ratio_is_not_a_slide() {
        let rising: Vec<_> = (0..200).map(|index| 0.004 * f64::from(index)).collect();
        assert_eq!(onset(&rising), None);
        assert_eq!(friction(&[]), None);
    }
}
