//! The clamp of a bottle on the torque sensor: play, and a spring beyond it.

use feeler::check::Checker;
use serde::{Deserialize, Serialize};

/// Clamp that holds objects on a thread to the torque sensor.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HolderConfig {
    /// Compliance of the clamp in x and y. Rigid by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lateral: Option<LateralConfig>,
    /// Rotational play: angle to either side of the start within which the torque sensor's shaft does not hold the
    /// bottle (rad). Within the play the sensor measures no torque.
    #[serde(default)]
    pub turn_play: f64,
}

/// Lateral compliance of a bottle's clamp, independent along W's x and y.
///
/// Within the play neither a spring nor friction acts on the bottle: it moves as the fingers push it, and stays there.
/// Beyond, the clamp pushes it back to the end of the play.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LateralConfig {
    /// Stiffness of the clamp along x and y (N/m).
    pub stiffness: [f64; 2],
    /// Play along x and y: distance to either side of the start within which the clamp does not hold the bottle (m).
    #[serde(default)]
    pub play: [f64; 2],
}

impl HolderConfig {
    /// Checks that every value of the table `key` is in its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        checker.between(&format!("{key}.turn_play"), self.turn_play, 0.0, 1.0);
        let Some(LateralConfig { stiffness, play }) = self.lateral else {
            return;
        };
        for axis in 0..2 {
            let key = |field: &str| format!("{key}.lateral.{field}[{axis}]");
            checker.positive(&key("stiffness"), stiffness[axis]);
            checker.between(&key("play"), play[axis], 0.0, 0.1);
        }
    }

    /// Springs that hold the bottle along W's x and y, or `None` if it cannot shift.
    pub fn sides(&self) -> Option<[PlaySpring; 2]> {
        let LateralConfig { stiffness, play } = self.lateral?;
        Some([0, 1].map(|axis| PlaySpring::new(stiffness[axis], play[axis])))
    }
}

/// A spring with play, linear (m, N) or torsional (rad, N·m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaySpring {
    /// Stiffness beyond the play.
    stiffness: f64,
    /// Reciprocal of the stiffness.
    compliance: f64,
    /// Free deflection to either side.
    play: f64,
}

impl PlaySpring {
    /// Creates a spring of `stiffness` beyond `play` to either side.
    pub fn new(stiffness: f64, play: f64) -> Self {
        Self {
            stiffness,
            compliance: stiffness.recip(),
            play,
        }
    }

    /// Returns `true` if the play is not zero.
    pub fn has_play(&self) -> bool {
        self.play > 0.0
    }

    /// Deflection under `load`, in the direction of the load, including the play.
    pub fn way(&self, load: f64) -> f64 {
        load * self.compliance + self.play.copysign(load)
    }

    /// Additional deflection due to an additional `load`.
    pub fn way_over(&self, load: f64) -> f64 {
        load * self.compliance
    }

    /// Magnitude of the change of load due to a deflection of `way` beyond the play.
    pub fn load_over(&self, way: f64) -> f64 {
        self.stiffness * way.abs()
    }

    /// Returns `true` if the spring, deflected to `at`, resists a load with the sign of `load`: the play is used up.
    pub fn holds(&self, at: f64, load: f64) -> bool {
        self.play == 0.0 || at * load.signum() >= self.play
    }

    /// Newton step from the deflection `at` towards balance with an external `load`, which decreases by `stiffness` per
    /// deflection. Stops at the ends of the play, where the spring's stiffness changes.
    pub fn give(&self, at: f64, load: f64, stiffness: f64) -> f64 {
        let bent_from = |end: f64| {
            let way = load * self.compliance + end;
            at + (way - at) / (1.0 + stiffness * self.compliance)
        };
        if self.holds(at, load) {
            return bent_from(self.play.copysign(load));
        }
        if at.abs() <= self.play {
            let to = at + load / stiffness.max(f64::MIN_POSITIVE);
            return to.max(-self.play).min(self.play);
        }
        // Returns from beyond the other end of the play.
        if at > 0.0 {
            bent_from(self.play).max(self.play)
        } else {
            bent_from(-self.play).min(-self.play)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Final deflection of a spring with play that is pulled by a softer spring, whose far end is at `drive`.
    fn settled(spring: &PlaySpring, from: f64, stiffness: f64, drive: f64) -> f64 {
        (0..4).fold(from, |at, _| {
            spring.give(at, stiffness * (drive - at), stiffness)
        })
    }

    #[test]
    fn newton_steps_find_the_balance_from_any_start() {
        let (stiffness, play, pull) = (50.0, 0.2, 8.0);
        let spring = PlaySpring::new(stiffness, play);
        for drive in [-1.0, -0.21, -0.1, 0.0, 0.15, 0.3, 2.0_f64] {
            for from in [-1.0, -0.2, -0.05, 0.0, 0.2, 0.7] {
                // k (x - play) = pull (drive - x) beyond the play; within it, no load.
                let beyond = (stiffness * play + pull * drive.abs()) / (stiffness + pull);
                let expected = match drive.abs() <= play {
                    true => drive,
                    false => beyond.copysign(drive),
                };
                let at = settled(&spring, from, pull, drive);
                // Only rounding errors: Newton's method is exact for piecewise linear functions.
                assert!((at - expected).abs() < 1e-15, "{at} from {from} to {drive}");
            }
        }
    }

    #[test]
    fn an_unloaded_bottle_stays_within_its_play() {
        let spring = PlaySpring::new(50.0, 0.2);
        assert_eq!(spring.give(0.13, 0.0, 0.0), 0.13);
        assert_eq!(spring.give(-0.2, 0.0, 0.0), -0.2);
        assert!((spring.give(0.3, 0.0, 0.0) - 0.2).abs() < 1e-15);
        assert!((spring.give(-0.3, 0.0, 0.0) + 0.2).abs() < 1e-15);
    }
}
