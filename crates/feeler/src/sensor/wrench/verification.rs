//! Tests whether a calibration is still valid, from a few presses with measured wrenches.
//!
//! The calibration contains a band that includes the errors of 95 % of the samples ([`AxisQuality::band_95`]). If it is
//! still valid, more than half of a press's samples are outside the band with a probability of at most 10 % (Markov's
//! inequality, for any distribution of the errors and any correlation within a press). A component is rejected if k of
//! n presses are outside and the binomial probability of k or more, at 10 % each, does not exceed the false-alarm rate,
//! which is divided among the components. If the errors of all presses in a session are fully correlated, the
//! false-alarm rate is at most 10 %.
//!
//! [`AxisQuality::band_95`]: super::quality::AxisQuality::band_95

use super::MeasuredWrench;
use super::basis::Basis;
use super::calibration::CalibrationOf;
use super::error::WrenchError;
use super::estimator::EstimatorOf;
pub use super::passport::{AxisVerification, Verification};
use super::presses::presses;
use super::quality::{AxisQuality, Errors};
use super::sample::SampleOf;
use crate::sensor::table::Quantity;

/// Maximum probability that more than half of a press's samples are outside the 95 % band of a valid calibration.
const MAX_OUTSIDE: f64 = 0.1;

/// Tests `calibration` with `samples`, in order of time within each recording. `date` is recorded as the date of the
/// test.
///
/// Samples outside the calibrated range of a component are ignored, and so are presses whose measured forces and
/// torques are all smaller than the band.
///
/// # Errors
/// If no component of the calibration was measured, if one was measured only outside its range or has an unknown error
/// band, or if there are too few presses to reject it.
pub fn verify<B: Basis>(
    calibration: &CalibrationOf<B>,
    samples: &[SampleOf<B>],
    date: &str,
    false_alarm_rate: f64,
) -> Result<Verification, WrenchError> {
    let mut samples: Vec<&SampleOf<B>> = samples.iter().collect();
    samples.sort_by_key(|sample| sample.recording);
    let mut presses = presses(&samples);
    presses.retain(|press| is_strong(calibration, press.iter().map(|&row| &samples[row].wrench)));
    let mut estimator = EstimatorOf::new(calibration.clone())?;
    let estimates = samples
        .iter()
        .map(|sample| estimator.estimate_with(|input| input.clone_from(&sample.seen)));
    let estimates: Vec<_> = estimates.collect();
    let compared = |quality: &AxisQuality| {
        let index = quality.axis.index();
        let [low, high] = quality.range;
        let pair = |row: usize| {
            let measured =
                samples[row].wrench[index].filter(|value| (low..=high).contains(value))?;
            let estimate = &estimates[row];
            let predicted = estimate.components[index].filter(|_| estimate.valid);
            Some((measured, predicted))
        };
        let presses = presses.iter();
        let presses = presses.map(|press| {
            press
                .iter()
                .filter_map(|&row| pair(row))
                .collect::<Vec<_>>()
        });
        presses
            .filter(|press| !press.is_empty())
            .collect::<Vec<_>>()
    };
    let tested = calibration
        .quality
        .iter()
        .map(|quality| (quality, compared(quality)));
    let (tested, untested): (Vec<_>, Vec<_>) = tested.partition(|(_, presses)| !presses.is_empty());
    for (quality, _) in untested {
        let mut values = presses.iter().flatten();
        if values.any(|&row| samples[row].wrench[quality.axis.index()].is_some()) {
            return Err(WrenchError::OutsideRange {
                axis: quality.axis.name(),
                unit: quality.axis.unit(),
                range: quality.range,
            });
        }
    }
    if tested.is_empty() {
        return Err(WrenchError::NotMeasured);
    }
    let rate = false_alarm_rate / tested.len() as f64;
    let axes = tested
        .iter()
        .map(|(quality, presses)| test(quality, presses, rate));
    let axes = axes.collect::<Result<Vec<_>, _>>()?;
    Ok(Verification {
        date: date.to_owned(),
        false_alarm_rate,
        valid: !axes.iter().any(AxisVerification::is_rejected),
        axes,
    })
}

/// Returns `true` if a press is strong enough for the test: a force or torque exceeds its error band, so that the press
/// would be outside for a sensor without response. Presses with a measured place of contact always are.
fn is_strong<'a, B: Basis>(
    calibration: &CalibrationOf<B>,
    wrenches: impl Iterator<Item = &'a MeasuredWrench> + Clone,
) -> bool {
    calibration.quality.iter().any(|quality| {
        let mut values = wrenches
            .clone()
            .filter_map(|wrench| wrench[quality.axis.index()]);
        let band = match quality.axis.quantity() {
            Quantity::Length => None,
            _ => quality.band_95,
        };
        values.any(|value| value.abs() > band.unwrap_or(-1.0))
    })
}

/// Measured value, and predicted value if it is valid.
type Compared = (f64, Option<f64>);

/// Tests one component, given the samples of each press.
fn test(
    quality: &AxisQuality,
    presses: &[Vec<Compared>],
    false_alarm_rate: f64,
) -> Result<AxisVerification, WrenchError> {
    let axis = quality.axis;
    let band = quality
        .band_95
        .ok_or(WrenchError::NoBand { axis: axis.name() })?;
    let is_outside = |press: &&Vec<Compared>| {
        let inside = press.iter().filter(|(measured, predicted)| {
            predicted.is_some_and(|predicted| (predicted - measured).abs() <= band)
        });
        2 * inside.count() < press.len()
    };
    let rejected_from = rejected_from(presses.len(), false_alarm_rate).ok_or_else(|| {
        WrenchError::TooFewPresses {
            expected: fewest_presses(false_alarm_rate),
            actual: presses.len(),
        }
    })?;
    let valid: Vec<[f64; 2]> = presses
        .iter()
        .flatten()
        .filter_map(|&(measured, predicted)| Some([measured, predicted?]))
        .collect();
    Ok(AxisVerification {
        axis,
        presses: presses.len(),
        outside: presses.iter().filter(is_outside).count(),
        rejected_from,
        errors: Errors::of(
            valid
                .iter()
                .map(|[measured, predicted]| predicted - measured),
        ),
        gain_drift: slope(&valid).map(|slope| slope - 1.0),
    })
}

/// Slope of the linear regression of measured on predicted values; `None` if the predicted values are constant.
fn slope(pairs: &[[f64; 2]]) -> Option<f64> {
    let count = pairs.len() as f64;
    let mean = |index: usize| pairs.iter().map(|pair| pair[index]).sum::<f64>() / count;
    let [measured, predicted] = [mean(0), mean(1)];
    let (mut common, mut square) = (0.0, 0.0);
    for pair in pairs {
        let away = pair[1] - predicted;
        common += away * (pair[0] - measured);
        square += away * away;
    }
    (square > 0.0).then(|| common / square)
}

/// Smallest k for which the probability that k or more of `presses` presses are outside the band of a valid calibration
/// is at most `rate`; `None` if there is no such k.
fn rejected_from(presses: usize, rate: f64) -> Option<usize> {
    let factorial = |n: usize| libm::lgamma(n as f64 + 1.0);
    let probability = |outside: usize| {
        let inside = presses - outside;
        let ways = factorial(presses) - factorial(outside) - factorial(inside);
        libm::exp(
            ways + outside as f64 * libm::log(MAX_OUTSIDE)
                + inside as f64 * libm::log(1.0 - MAX_OUTSIDE),
        )
    };
    let mut sum = 0.0;
    let most_first = (1..=presses).rev();
    let rarer = most_first.take_while(|&outside| {
        sum += probability(outside);
        sum <= rate
    });
    rarer.last()
}

/// Minimum number of presses for which a calibration can be rejected at the false-alarm rate `rate`.
fn fewest_presses(rate: f64) -> usize {
    (1..)
        .find(|&presses| rejected_from(presses, rate).is_some())
        .unwrap_or(usize::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Critical numbers from a table of the binomial distribution with p = 0.1: P(X >= 3 of 5) = 0.00856,
    /// P(X >= 2 of 5) = 0.0815, P(X >= 4 of 10) = 0.0128, P(X >= 5 of 10) = 0.00163, P(X = 2 of 2) = 0.01.
    #[test]
    fn critical_numbers_are_those_of_the_binomial_distribution() {
        for (presses, rate, expected) in [
            (5, 0.01, Some(3)),
            (5, 0.1, Some(2)),
            (10, 0.0129, Some(4)),
            (10, 0.01, Some(5)),
            (2, 0.0101, Some(2)),
            (1, 0.01, None),
            (0, 0.5, None),
        ] {
            assert_eq!(
                rejected_from(presses, rate),
                expected,
                "{presses} presses, {rate}"
            );
        }
        assert_eq!(fewest_presses(0.0099), 3);
        assert_eq!(rejected_from(1000, 0.01), Some(124));
    }
}
