//! Identification of a joint's torque constant and friction from sweeps under known loads.
//!
//! A joint that moves slowly in the direction `s` (1 or -1) under the load `L` requires the current `a L + b s + c`: the
//! torque constant is `1 / a`, the friction `b / a`, and `c` is due to the weight of the finger itself.

use crate::config::TorqueCalibration;
use glam::{DMat3, DVec3};

/// Minimum number of samples per direction.
const LEAST: usize = 3;
/// Maximum relative standard error of the torque constant.
const MOST_ERROR: f64 = 0.1;
/// Maximum deviation of a sample from the fit, relative to the current of the greatest load.
const MOST_DEVIATION: f64 = 0.2;

/// Mean of one sweep in one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TorqueSample {
    /// Known torque of the load against positive motion, N m (N for a prismatic joint).
    pub load: f64,
    /// Direction of the motion: 1 or -1.
    pub direction: f64,
    /// Mean current, A, positive if it increases the joint's position.
    pub current: f64,
}

/// Error of an identification.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum IdentifyError {
    /// Too few samples, or all samples have the same load or direction.
    #[error(
        "{count} sweeps with {loads} different loads: expected at least 2 loads and {LEAST} sweeps in each direction"
    )]
    TooFew {
        /// Number of sweeps.
        count: usize,
        /// Number of different loads.
        loads: usize,
    },
    /// A sample is not a finite number.
    #[error("the current or load of a sweep is not a number: check the servo's current")]
    NotFinite,
    /// The current does not rise with the load.
    #[error(
        "the current changes by {slope:.3} A per {unit} of load: expected a rise; check that the loads act against positive motion, and the joint's direction"
    )]
    NoRise {
        /// Change of the current per load, A/(N m) or A/N.
        slope: f64,
        /// Unit of the loads.
        unit: &'static str,
    },
    /// The torque constant is imprecise.
    #[error(
        "the torque constant {constant:.4} {unit}/A has a standard error of {error:.4}: expected at most a tenth; use greater loads, or more sweeps"
    )]
    Imprecise {
        /// Torque constant, N m/A or N/A.
        constant: f64,
        /// Standard error, N m/A or N/A.
        error: f64,
        /// Unit of the loads.
        unit: &'static str,
    },
    /// The fitted friction is negative.
    #[error(
        "the friction is {friction:.4} {unit} with a standard error of {error:.4}: expected none below zero; sweep slower, and check that the joint moves freely"
    )]
    NegativeFriction {
        /// Friction, N m or N.
        friction: f64,
        /// Standard error, N m or N.
        error: f64,
        /// Unit of the loads.
        unit: &'static str,
    },
    /// The sweeps contradict each other.
    #[error(
        "the sweep with a load of {load:.4} {unit} required {current:.4} A: the fit to all sweeps predicts {expected:.4} A (tolerance: {MOST_DEVIATION} of the current for the range of loads); check this load, and that nothing else touches the finger"
    )]
    Contradiction {
        /// Load of the sweep, N m or N.
        load: f64,
        /// Unit of the loads.
        unit: &'static str,
        /// Current of the sweep, A.
        current: f64,
        /// Current predicted by the fit, A.
        expected: f64,
    },
}

/// Fits the torque constant and the friction to sweeps, by least squares. `unit` is that of the loads, for messages: `N m`,
/// or `N` of a prismatic joint.
///
/// # Errors
/// If the sweeps do not determine them, or contradict each other.
pub fn identify_torque(
    samples: &[TorqueSample],
    unit: &'static str,
) -> Result<TorqueCalibration, IdentifyError> {
    check(samples)?;
    let row = |sample: &TorqueSample| DVec3::new(sample.load, sample.direction, 1.0);
    let mut normal = DMat3::ZERO;
    let mut right = DVec3::ZERO;
    for sample in samples {
        let row = row(sample);
        normal += DMat3::from_cols(row * row.x, row * row.y, row * row.z);
        right += row * sample.current;
    }
    // Regular, since there are two loads and two directions.
    let inverse = normal.inverse();
    let fit = inverse * right;
    let residual = |sample: &TorqueSample| sample.current - fit.dot(row(sample));
    let squares: f64 = samples.iter().map(|sample| residual(sample).powi(2)).sum();
    let variance = squares / (samples.len() - 3) as f64;
    let covariance = inverse * variance;
    let (slope, offset) = (fit.x, fit.y);
    if slope.is_nan() || slope <= 0.0 {
        return Err(IdentifyError::NoRise { slope, unit });
    }
    let loads = samples.iter().map(|sample| sample.load);
    let range = loads.clone().fold(f64::MIN, f64::max) - loads.fold(f64::MAX, f64::min);
    let most = MOST_DEVIATION * slope * range;
    if let Some(sample) = samples.iter().find(|sample| residual(sample).abs() > most) {
        return Err(IdentifyError::Contradiction {
            load: sample.load,
            unit,
            current: sample.current,
            expected: fit.dot(row(sample)),
        });
    }
    let constant = 1.0 / slope;
    let constant_error = covariance.x_axis.x.max(0.0).sqrt() / slope.powi(2);
    if constant_error > MOST_ERROR * constant {
        return Err(IdentifyError::Imprecise {
            constant,
            error: constant_error,
            unit,
        });
    }
    let friction = offset / slope;
    let gradient = DVec3::new(-offset / slope.powi(2), 1.0 / slope, 0.0);
    let friction_error = gradient.dot(covariance * gradient).max(0.0).sqrt();
    if friction < -3.0 * friction_error {
        return Err(IdentifyError::NegativeFriction {
            friction,
            error: friction_error,
            unit,
        });
    }
    Ok(TorqueCalibration {
        constant,
        constant_error,
        friction: friction.max(0.0),
        friction_error,
    })
}

/// Checks that there are enough finite samples.
fn check(samples: &[TorqueSample]) -> Result<(), IdentifyError> {
    let numbers = samples
        .iter()
        .flat_map(|s| [s.load, s.direction, s.current]);
    if !numbers.into_iter().all(f64::is_finite) {
        return Err(IdentifyError::NotFinite);
    }
    let mut loads: Vec<_> = samples.iter().map(|sample| sample.load).collect();
    loads.sort_by(f64::total_cmp);
    loads.dedup();
    let of = |direction: f64| samples.iter().filter(|s| s.direction == direction).count();
    if loads.len() < 2 || of(1.0) < LEAST || of(-1.0) < LEAST {
        return Err(IdentifyError::TooFew {
            count: samples.len(),
            loads: loads.len(),
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    /// Sweeps of a motor with 0.36 N m/A and 0.012 N m of friction, whose finger weighs as much as 0.004 A.
    fn sweeps(noise: f64, seed: u64) -> Vec<TorqueSample> {
        let mut random = Pcg64::seed_from_u64(seed);
        let mut samples = Vec::new();
        for load in [0.0, 0.03, 0.06] {
            for _ in 0..4 {
                for direction in [1.0, -1.0] {
                    let noise = noise * random.random_range(-1.0..=1.0);
                    let current = (load + 0.012 * direction) / 0.36 + 0.004 + noise;
                    samples.push(TorqueSample {
                        load,
                        direction,
                        current,
                    });
                }
            }
        }
        samples
    }

    #[test]
    fn exact_sweeps_are_identified_exactly() {
        let found = identify_torque(&sweeps(0.0, 1), "N m").unwrap();
        assert!((found.constant - 0.36).abs() < 1e-9, "{found:?}");
        assert!((found.friction - 0.012).abs() < 1e-9, "{found:?}");
        assert!(found.constant_error < 1e-6 && found.friction_error < 1e-6);
    }

    /// The true values are within two standard errors in 95 % of the cases.
    #[test]
    fn standard_errors_are_those_of_repeated_identifications() {
        let (mut constants, mut frictions) = (0, 0);
        for seed in 0..400 {
            let found = identify_torque(&sweeps(0.004, seed), "N m").unwrap();
            constants += u32::from((found.constant - 0.36).abs() < 2.0 * found.constant_error);
            frictions += u32::from((found.friction - 0.012).abs() < 2.0 * found.friction_error);
        }
        // 5 standard deviations of a binomial distribution.
        for within in [constants, frictions] {
            assert!(
                (356..=398).contains(&within),
                "{constants} {frictions} of 400"
            );
        }
    }

    #[test]
    fn sweeps_that_contradict_each_other_are_refused() {
        let refused = |samples: &[TorqueSample], word: &str| {
            let error = identify_torque(samples, "N").unwrap_err().to_string();
            assert!(error.contains(word), "no {word:?} in {error}");
        };
        let good = sweeps(0.002, 1);
        let mut one_load = good.clone();
        one_load.retain(|sample| sample.load == 0.0);
        refused(&one_load, "1 different loads");
        let mut upward = good.clone();
        upward.retain(|sample| sample.direction > 0.0);
        refused(&upward, "in each direction");
        refused(&[], "0 sweeps");
        let mut reversed = good.clone();
        for sample in &mut reversed {
            sample.load = -sample.load;
        }
        refused(&reversed, "A per N of load: expected a rise");
        let mut touched = good.clone();
        touched[9].current += 0.1;
        refused(&touched, "nothing else touches");
        let mut driven = good.clone();
        for sample in &mut driven {
            sample.current -= 3.0 * 0.012 * sample.direction / 0.36;
        }
        refused(&driven, "below zero");
        let mut broken = good;
        broken[0].current = f64::NAN;
        refused(&broken, "not a number");
    }

    #[test]
    fn small_loads_are_imprecise() {
        let mut samples = sweeps(0.0, 1);
        for (index, sample) in samples.iter_mut().enumerate() {
            sample.current += if (index / 2) % 2 == 0 { 0.02 } else { -0.02 };
        }
        let small: Vec<_> = samples.iter().copied().filter(|s| s.load < 0.05).collect();
        let error = identify_torque(&small, "N m").unwrap_err();
        assert!(
            matches!(
                error,
                IdentifyError::Imprecise { .. } | IdentifyError::Contradiction { .. }
            ),
            "{error:?}"
        );
    }
}
