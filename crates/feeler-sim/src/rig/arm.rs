//! The arm that carries the hand: prescribed translations of the hand through its surroundings.
//!
//! W is fixed to the base of the hand. While the arm moves the hand by p(t), fixed objects therefore move by -p(t) in
//! W, and the inertial force -m p''(t) acts on free bodies. The motion is not an input of the hand's controller.

use feeler::check::Checker;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// Maximum number of motions of an arm; each is evaluated in every step.
const MAX_MOTIONS: usize = 64;
/// Interval of the difference quotient for the acceleration (s).
const INTERVAL: f64 = 1e-4;

/// A motion of the arm in an experiment file. Motions at the same time add up.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ArmMotion {
    /// Start of the motion (s).
    pub from: f64,
    /// End of the motion (s).
    pub until: f64,
    /// Kind of the motion.
    pub kind: ArmMotionKind,
}

/// Kind of a motion of the arm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ArmMotionKind {
    /// Translation from rest to rest with minimum jerk: `s³ (10 - 15 s + 6 s²)` of the displacement after the fraction
    /// `s` of the duration.
    Travel {
        /// Displacement of the hand (m).
        by: [f64; 3],
    },
    /// Harmonic oscillation that starts and ends at rest: `sin(2π f t) sin²(π s)` of the amplitude at the time `t`
    /// since the start, after the fraction `s` of the duration.
    Shake {
        /// Maximum displacement of the hand (m).
        amplitude: [f64; 3],
        /// Frequency f (Hz).
        frequency: f64,
    },
}

impl ArmMotion {
    /// Displacement (m) of the hand by this motion at `time` (s).
    fn position(&self, time: f64) -> DVec3 {
        let share = ((time - self.from) / (self.until - self.from)).clamp(0.0, 1.0);
        match self.kind {
            ArmMotionKind::Travel { by } => {
                share
                    * share
                    * share
                    * (10.0 - 15.0 * share + 6.0 * share * share)
                    * DVec3::from(by)
            }
            ArmMotionKind::Shake {
                amplitude,
                frequency,
            } => {
                let envelope = libm::sin(PI * share);
                let wave = libm::sin(TAU * frequency * (time - self.from));
                wave * envelope * envelope * DVec3::from(amplitude)
            }
        }
    }

    /// Checks that every value of the table `key` is in its range.
    fn check(&self, key: &str, checker: &mut Checker) {
        checker.not_negative(&format!("{key}.from"), self.from);
        let until = ("until", self.until);
        checker.more_than(key, until, ("from", self.from));
        match self.kind {
            ArmMotionKind::Travel { by } => checker.vector(&format!("{key}.kind.travel.by"), by),
            ArmMotionKind::Shake {
                amplitude,
                frequency,
            } => {
                let key = format!("{key}.kind.shake");
                checker.vector(&format!("{key}.amplitude"), amplitude);
                checker.between(&format!("{key}.frequency"), frequency, 0.01, 100.0);
            }
        }
    }
}

/// Displacement (m) of the hand by all `motions` at `time` (s).
pub fn displacement(motions: &[ArmMotion], time: f64) -> DVec3 {
    motions.iter().map(|motion| motion.position(time)).sum()
}

/// Acceleration (m/s²) of the hand by all `motions` at `time` (s). Zero at the start and end of each motion.
pub fn acceleration(motions: &[ArmMotion], time: f64) -> DVec3 {
    let at = |time| displacement(motions, time);
    let change = at(time + INTERVAL) - 2.0 * at(time) + at(time - INTERVAL);
    change / (INTERVAL * INTERVAL)
}

/// Checks the table `sim.arm`. `turns` is `true` if an object turns on a hinge or thread, which an arm cannot carry past
/// the hand.
pub(crate) fn check(motions: &[ArmMotion], turns: bool, checker: &mut Checker) {
    checker.require(
        "sim.arm",
        format!("{} motions", motions.len()),
        motions.len() <= MAX_MOTIONS,
        &format!("at most {MAX_MOTIONS}"),
    );
    checker.require(
        "sim.arm",
        "an object that turns".to_string(),
        motions.is_empty() || !turns,
        "only fixed and free objects with an arm",
    );
    for (index, motion) in motions.iter().enumerate() {
        motion.check(&format!("sim.arm[{index}]"), checker);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn motion(kind: ArmMotionKind) -> ArmMotion {
        ArmMotion {
            from: 1.0,
            until: 3.0,
            kind,
        }
    }

    /// Closed forms: a minimum-jerk travel by d in the time T reaches the acceleration 10 d / (√3 T²) at the share
    /// (3 - √3) / 6; a shake has -(2π f)² times the amplitude at a crest in its middle, minus 2 (π/T)² of the envelope.
    #[test]
    fn accelerations_equal_closed_forms() {
        let travel = [motion(ArmMotionKind::Travel {
            by: [0.0, 0.0, 0.2],
        })];
        let time = 1.0 + 2.0 * (3.0 - 3.0_f64.sqrt()) / 6.0;
        let expected = 10.0 * 0.2 / (3.0_f64.sqrt() * 4.0);
        // Rounding errors of 1e-17 m over the squared interval, and its square times the fourth derivative.
        assert!((acceleration(&travel, time).z - expected).abs() < 1e-7);
        assert_eq!(displacement(&travel, 0.5).z, 0.0);
        assert_eq!(displacement(&travel, 5.0).z, 0.2);
        let amplitude = [0.001, 0.0, 0.0];
        let frequency = 2.25;
        let shake = [motion(ArmMotionKind::Shake {
            amplitude,
            frequency,
        })];
        // A crest: 2.25 cycles after the start.
        let expected = -0.001 * ((TAU * frequency).powi(2) + 2.0 * (PI / 2.0).powi(2));
        assert!((acceleration(&shake, 2.0).x - expected).abs() < 1e-6);
    }
}
