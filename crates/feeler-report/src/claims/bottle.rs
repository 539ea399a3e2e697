//! The paper's claims that also depend on its bottle and torque sensor: the time of closing and the torque over time.

use super::measured::{change, ratio};
use crate::measures::claim::{Claim, part};
use crate::measures::paths::{LaggedCorrelation, lagged_correlation};
use crate::measures::peaks::{PEAK_ENDS_BELOW, PEAK_RISES_ABOVE};
use crate::measures::series::{absolute_rate, count_peaks, mean, moving_mean};
use crate::measures::smoothing::smoothing_window;
use crate::run::data::RunData;
use crate::run::stroke::Stroke;

/// Maximum lag between torque rate and shear rate (s).
const MAX_LAG: f64 = 0.05;

pub(super) fn four_peaks(data: &RunData) -> Claim {
    let window = smoothing_window(&data.facts);
    let peaks = |values: Vec<f64>| {
        let smooth = moving_mean(&values, window);
        count_peaks(&smooth, PEAK_RISES_ABOVE, PEAK_ENDS_BELOW)
    };
    let counts = match &data.thinned {
        Some(thinned) => [thinned.grasp_force_peaks, thinned.torque_peaks],
        None => {
            let rows = 0..data.time.len();
            let grasp_force = peaks(rows.map(|row| data.grasp_force(row)).collect());
            [grasp_force, torque_over_strokes(data).and_then(peaks)]
        }
    };
    let [grasp_force, torque] = counts.map(|count| count.map(|count| count as f64));
    let bound = f64::from(data.facts.stroke_count);
    Claim::new(
        "four-peaks",
        "Grasp force and torque each have one peak per stroke (four in the paper).",
        vec![
            part("peaks of grasp force").equals(grasp_force, bound),
            part("peaks of torque").equals(torque, bound),
        ],
    )
}

/// Torque from the first sample of the torque sensor on (N·m); `None` if the first MOVE, and possibly the first peak,
/// precedes that sample.
fn torque_over_strokes(data: &RunData) -> Option<Vec<f64>> {
    let torque = data.torque.as_ref()?;
    let first = torque.iter().position(|torque| torque.is_finite())?;
    let mut moves = data.strokes.iter().filter(|s| !s.moving.is_empty());
    let in_time = moves.next().is_none_or(|s| first <= s.moving.start);
    in_time.then(|| torque[first..].to_vec())
}

pub(super) fn first_stroke_torque_rises(data: &RunData) -> Claim {
    let thirds = data.whole_stroke(1).map(|stroke| {
        let moving = stroke.moving.clone();
        let third = moving.len() / 3;
        (
            moving.start..moving.start + third,
            moving.end - third..moving.end,
        )
    });
    let first_and_last = |value: &dyn Fn(usize) -> f64| {
        let (first, last) = thirds.clone()?;
        Some((mean(first.map(value))?, mean(last.map(value))?))
    };
    let torque = data.torque.as_ref();
    let torque = torque.and_then(|torque| first_and_last(&|row| torque[row]));
    let torque = torque.and_then(|(a, b)| ratio(b, a));
    let grasp_force = first_and_last(&|row| data.grasp_force(row)).and_then(|(a, b)| change(a, b));
    Claim::new(
        "first-stroke-torque-rises",
        "In stroke 1, torque rises while grasp force stays constant.",
        vec![
            part("torque, last third of MOVE relative to first third").at_least(torque, 2.0),
            part("change of mean grasp force from first third to last").within(grasp_force, 0.30),
        ],
    )
}

/// Minimum correlation of torque rate and shear rate for a hand with two fingers.
const IN_STEP: f64 = 0.4;

/// Correlation between the magnitude of a sum and the sum of magnitudes of `fingers` independent normal variables.
///
/// Torque is the sum of the fingers' contributions, and the fingers slip at different times. The more fingers, the less
/// a bump of one finger contributes to the rate of the sum. Follows from E|XY| = 2/π (√(1-r²) + r asin r) for normal
/// variables with correlation r, with r = 1/√fingers.
fn of_independent_fingers(fingers: usize) -> f64 {
    use std::f64::consts::FRAC_2_PI;
    let n = fingers as f64;
    let r = n.sqrt().recip();
    let covariance = (1.0 - r * r).sqrt() + r * r.asin() - 1.0;
    n.sqrt() * FRAC_2_PI * covariance / (1.0 - FRAC_2_PI)
}

/// Minimum correlation of torque rate and shear rate for a hand with `fingers` fingers, rounded to two digits. Fewer
/// than two fingers count as two.
fn least_in_step(fingers: usize) -> f64 {
    let share = of_independent_fingers(fingers.max(2)) / of_independent_fingers(2);
    (100.0 * IN_STEP * share).round() / 100.0
}

pub(super) fn bumps_in_step(data: &RunData) -> Claim {
    let stretches: Option<Vec<_>> = [3, 4]
        .map(|index| rates(data, data.whole_stroke(index)?))
        .into_iter()
        .collect();
    let max_lag = (MAX_LAG / data.facts.control_period).round() as usize;
    let best: Option<LaggedCorrelation> =
        stretches.and_then(|stretches| lagged_correlation(&stretches, max_lag));
    let lag = best.map(|best| f64::from(best.lag) * data.facts.control_period);
    Claim::new(
        "bumps-in-step",
        "Bumps in shear rate and torque coincide (MOVE of strokes 3 and 4).",
        vec![
            part("correlation of |d torque/dt| and shear rate").at_least(
                best.map(|best| best.correlation),
                least_in_step(data.fingers.len()),
            ),
            part("lag of torque").in_unit("s").within(lag, MAX_LAG),
        ],
    )
}

/// Shear rate and absolute torque rate over MOVE. Both are absolute differences between consecutive control steps (the
/// shear rate by definition), smoothed by the same centred moving mean of [`SMOOTHING`](super::SMOOTHING), which removes the A/D
/// converter noise that differencing amplifies. The torque sensor's delay is not compensated; it appears as lag. `None`
/// without a torque sensor.
pub fn rates(data: &RunData, stroke: &Stroke) -> Option<(Vec<f64>, Vec<f64>)> {
    let first = stroke.moving.start.max(1);
    let rows = first..stroke.moving.end.max(first);
    let window = smoothing_window(&data.facts);
    let shear: Vec<f64> = rows.clone().map(|row| data.shear_rate(row)).collect();
    let torque = data.torque.as_ref()?.get(first - 1..rows.end)?;
    let torque = absolute_rate(torque, data.facts.control_period);
    Some((moving_mean(&shear, window), moving_mean(&torque, window)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn correlation_of_bumps_decreases_with_the_number_of_fingers() {
        // From 400,000 draws of Python's `random`.
        for (fingers, drawn) in [(1, 1.0), (2, 0.6502), (3, 0.5219), (4, 0.4484)] {
            let share = of_independent_fingers(fingers);
            assert!((share - drawn).abs() < 2e-3, "{fingers}: {share}");
        }
        assert_eq!([1, 2, 3, 4].map(least_in_step), [0.4, 0.4, 0.32, 0.28]);
    }
}
