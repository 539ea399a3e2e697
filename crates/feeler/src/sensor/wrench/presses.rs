//! Splits samples into presses: the independent observations of a calibration.

use super::basis::Basis;
use super::sample::SampleOf;
use super::{MeasuredWrench, WrenchAxis};
use crate::sensor::table::Quantity;

/// Load below which the fingertip counts as released, as a fraction of the largest load.
const RELEASED: f64 = 0.1;

/// Returns the indices of the samples of each press, in order. `samples` are in order of time within each recording.
///
/// A press consists of consecutive samples of one recording with more than a tenth of the largest load. Without
/// measured forces or torques, it consists of consecutive samples at the same place of contact.
pub(super) fn presses<B: Basis>(samples: &[&SampleOf<B>]) -> Vec<Vec<usize>> {
    let scales = largest_values(samples);
    let loaded = |sample: &SampleOf<B>| match &scales {
        Some(scales) => load(&sample.wrench, scales) > RELEASED,
        None => true,
    };
    let place = |sample: &SampleOf<B>| {
        [WrenchAxis::PlaceX, WrenchAxis::PlaceY].map(|axis| sample.wrench[axis.index()])
    };
    let mut presses: Vec<Vec<usize>> = Vec::new();
    let mut previous: Option<&SampleOf<B>> = None;
    for (row, &sample) in samples.iter().enumerate() {
        if !loaded(sample) {
            previous = None;
            continue;
        }
        let continues = previous.is_some_and(|previous| {
            let same_place = scales.is_some() || place(previous) == place(sample);
            previous.recording == sample.recording && same_place
        });
        match presses.last_mut().filter(|_| continues) {
            Some(press) => press.push(row),
            None => presses.push(vec![row]),
        }
        previous = Some(sample);
    }
    presses
}

/// Largest magnitudes of force (N) and torque (N·m); `None` if neither was measured.
fn largest_values<B: Basis>(samples: &[&SampleOf<B>]) -> Option<[f64; 2]> {
    let mut largest = [0.0, 0.0];
    for sample in samples {
        let lengths =
            [Quantity::Force, Quantity::Torque].map(|quantity| length(&sample.wrench, quantity));
        for (largest, length) in largest.iter_mut().zip(lengths) {
            *largest = f64::max(*largest, length);
        }
    }
    (largest != [0.0; 2]).then_some(largest)
}

/// Load relative to the largest force or torque, 0 to 1.
fn load(wrench: &MeasuredWrench, [force, torque]: &[f64; 2]) -> f64 {
    let part = |quantity, largest: f64| match largest > 0.0 {
        true => length(wrench, quantity) / largest,
        false => 0.0,
    };
    part(Quantity::Force, *force).max(part(Quantity::Torque, *torque))
}

/// Magnitude of the measured components of a force (N) or torque (N·m).
fn length(wrench: &MeasuredWrench, quantity: Quantity) -> f64 {
    let own = WrenchAxis::ALL
        .iter()
        .zip(wrench)
        .filter(|(axis, _)| axis.quantity() == quantity);
    own.filter_map(|(_, value)| *value)
        .map(|value| value * value)
        .sum::<f64>()
        .sqrt()
}
