//! Lag and delay of the drives, from commanded joint velocities and measured joint angles.

use super::noise::Measured;
use super::trace::FingerTrace;
use feeler::hand::JointVector;

/// Duration of the sections in which the modelled joint angles have separate offsets (s), to allow for drift of a
/// drive.
const STRETCH: f64 = 1.0;
/// Maximum lag of the drives that the fit considers (s).
const MAX_LAG: f64 = 0.2;
/// Maximum delay of the encoders that the fit considers (s).
const MAX_DELAY: f64 = 0.1;
/// Minimum lag of the drives that the fit considers (s).
const MIN_LAG: f64 = 1e-4;
/// Convergence tolerance of the golden-section search (s).
const ACCURACY: f64 = 5e-5;

/// Lag and delay of a finger's drives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriveLag {
    /// First-order time constant (s).
    pub lag: Measured,
    /// Delay from a command to the beginning of the motion (s).
    pub delay: Measured,
}

/// State of a first-order drive.
#[derive(Debug, Clone, Copy, Default)]
struct Drive {
    velocity: JointVector,
    angle: JointVector,
}

impl Drive {
    /// Advances the exact solution by `time` (s), for the constant velocity `command` and the time constant `lag` (s).
    fn follow(&mut self, command: JointVector, time: f64, lag: f64) {
        let decay = (-time / lag).exp();
        let behind = self.velocity - command;
        self.angle += command * time + behind * lag * (1.0 - decay);
        self.velocity = command + behind * decay;
    }
}

/// Measured minus modelled joint angles (rad), relative to their mean in each section; flattened over rows and joints.
fn residuals(trace: &FingerTrace, lag: f64, delay: f64) -> Vec<f64> {
    let rows = &trace.rows;
    let mut drive = Drive::default();
    let mut differences = Vec::with_capacity(rows.len());
    let command_at = |index: usize, back: usize| match index.checked_sub(back) {
        Some(index) => rows[index].command,
        None => JointVector::default(),
    };
    for (index, row) in rows.iter().enumerate() {
        differences.push(row.joints - drive.angle);
        let Some(next) = rows.get(index + 1) else {
            break;
        };
        let period = next.time - row.time;
        // During the first part of the period, the previous command is still effective.
        let back = (delay / period) as usize;
        let older = delay - back as f64 * period;
        drive.follow(command_at(index, back + 1), older, lag);
        drive.follow(command_at(index, back), period - older, lag);
    }
    let mut flat = Vec::new();
    let mut from = 0;
    while from < rows.len() {
        let end = rows[from..].partition_point(|row| row.time < rows[from].time + STRETCH);
        let stretch = &differences[from..from + end];
        let sum = stretch
            .iter()
            .fold(JointVector::default(), |sum, &d| sum + d);
        let mean = sum / stretch.len() as f64;
        for &difference in stretch {
            flat.extend((difference - mean).iter());
        }
        from += end;
    }
    flat
}

fn squares(residuals: &[f64]) -> f64 {
    residuals.iter().map(|r| r * r).sum()
}

/// Estimates lag and delay by least squares. Returns `None` if the drives hardly moved.
pub fn drive_lag(trace: &FingerTrace) -> Option<DriveLag> {
    let moved = trace.rows.iter().any(|row| row.command.length() > 1e-3);
    if !moved {
        return None;
    }
    let cost = |lag: f64, delay: f64| squares(&residuals(trace, lag, delay));
    let lag_at = |delay: f64| least_of((MIN_LAG, MAX_LAG), |lag| cost(lag, delay));
    let delay = least_of((0.0, MAX_DELAY), |delay| cost(lag_at(delay), delay));
    let best = (lag_at(delay), delay);
    let curvature = Curvature::at(trace, best);
    let (lag, delay) = best;
    Some(DriveLag {
        lag: Measured {
            value: lag,
            deviation: curvature.deviations.0,
        },
        delay: Measured {
            value: delay,
            deviation: curvature.deviations.1,
        },
    })
}

/// Minimises the unimodal function `cost` between two bounds by golden-section search.
fn least_of((mut low, mut high): (f64, f64), cost: impl Fn(f64) -> f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let inner = |low: f64, high: f64| (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
    let (mut a, mut b) = inner(low, high);
    let (mut at_a, mut at_b) = (cost(a), cost(b));
    while high - low > ACCURACY {
        if at_a <= at_b {
            (high, b, at_b) = (b, a, at_a);
            a = inner(low, high).0;
            at_a = cost(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = inner(low, high).1;
            at_b = cost(b);
        }
    }
    0.5 * (low + high)
}

/// Curvature of the cost at the estimated lag and delay.
struct Curvature {
    /// Standard deviations of the estimated lag and delay (s).
    deviations: (f64, f64),
}

impl Curvature {
    fn at(trace: &FingerTrace, (lag, delay): (f64, f64)) -> Self {
        let at = residuals(trace, lag, delay);
        let by = 2e-4;
        let slope = |lag, delay| -> Vec<f64> {
            let moved = residuals(trace, lag, delay);
            moved.iter().zip(&at).map(|(m, a)| (m - a) / by).collect()
        };
        let (by_lag, by_delay) = (slope(lag + by, delay), slope(lag, delay + by));
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (ll, dd) = (dot(&by_lag, &by_lag), dot(&by_delay, &by_delay));
        let ld = dot(&by_lag, &by_delay);
        let determinant = (ll * dd - ld * ld).max(f64::MIN_POSITIVE);
        let variance = squares(&at) / (at.len() as f64 - 2.0).max(1.0);
        Self {
            deviations: (
                (variance * dd / determinant).sqrt(),
                (variance * ll / determinant).sqrt(),
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::trace::Row;
    use super::*;
    use feeler::control::FingertipPose;
    use feeler::control::task::probe::Step;
    use feeler::sensor::fingertip::{ElementLayout, LayoutConfig};
    use glam::DVec3;

    /// Joint angles that follow changing commands with the given lag and delay, computed in steps of 0.1 ms.
    fn trace(lag: f64, delay: f64) -> FingerTrace {
        let command_at = |time: f64| match time {
            time if time < 0.0 => JointVector::zeros(3),
            time => {
                0.05 * JointVector::from([
                    (3.0 * time).sin().signum(),
                    0.4,
                    (7.0 * time).cos().signum(),
                ])
            }
        };
        let (mut drive, mut rows) = (Drive::default(), Vec::new());
        for index in 0..600 {
            let time = 0.01 * f64::from(index);
            rows.push(Row {
                time,
                step: Step::Rest,
                place: 0,
                command: command_at(time),
                joints: drive.angle,
                pose: FingertipPose::default(),
                forces: Vec::new(),
            });
            for part in 0..100 {
                // Commands change only at control steps.
                let since = time + 1e-4 * f64::from(part) + 5e-5 - delay;
                drive.follow(command_at((since / 0.01).floor() * 0.01), 1e-4, lag);
            }
        }
        FingerTrace {
            layout: ElementLayout::new(&LayoutConfig::default()),
            approach: DVec3::X,
            axis: DVec3::Z,
            rows,
        }
    }

    #[test]
    fn lag_and_delay_of_exact_joints_are_found() {
        for (lag, delay) in [(0.003, 0.0), (0.03, 0.0), (0.012, 0.017)] {
            let found = drive_lag(&trace(lag, delay)).expect("it moves");
            // The search ends within 0.05 ms, and lag and delay are correlated.
            assert!(
                (found.lag.value - lag).abs() < 3e-4,
                "{lag} {delay} {found:?}"
            );
            assert!(
                (found.delay.value - delay).abs() < 3e-4,
                "{lag} {delay} {found:?}"
            );
        }
    }

    #[test]
    fn a_finger_at_rest_has_no_lag() {
        let mut trace = trace(0.01, 0.0);
        for row in &mut trace.rows {
            row.command = JointVector::zeros(3);
        }
        assert_eq!(drive_lag(&trace), None);
    }
}
