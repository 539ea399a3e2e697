//! How a bottle is held on the torque sensor: with some play, and a spring beyond it.

use feeler::check::Checker;
use serde::{Deserialize, Serialize};

/// How what stands on a thread is held on the torque sensor.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HolderConfig {
    /// How it shifts; by default it does not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lateral: Option<LateralConfig>,
    /// Play in turn: how far it turns to either side of where it starts before the torque sensor's
    /// shaft holds it, rad. Until then it bears no torque, and the sensor shows none.
    #[serde(default)]
    pub turn_play: f64,
}

/// How a bottle shifts in its clamp, along W's x and along its y, each by itself.
///
/// Within the play nothing holds it, neither spring nor friction: it goes where the fingers push it and stays
/// where they leave it. Beyond, the clamp pushes it back to the end of the play.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LateralConfig {
    /// Stiffness of the clamp along x and along y, N/m.
    pub stiffness: [f64; 2],
    /// How far the bottle shifts to either side of where it starts before the clamp holds it, along x and
    /// along y, m.
    #[serde(default)]
    pub play: [f64; 2],
}

impl HolderConfig {
    /// Requires every value of the table `key` to be in its range.
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

    /// What holds the bottle along W's x and y, if it can shift.
    pub fn sides(&self) -> Option<[PlaySpring; 2]> {
        let LateralConfig { stiffness, play } = self.lateral?;
        Some([0, 1].map(|axis| PlaySpring::new(stiffness[axis], play[axis])))
    }
}

/// A spring that holds nothing within a play, along a line (m, N) or about an axis (rad, N·m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaySpring {
    /// Load per way beyond the play, and its reciprocal.
    stiffness: f64,
    compliance: f64,
    /// Way to either side before it holds anything.
    play: f64,
}

impl PlaySpring {
    /// A spring of `stiffness` beyond `play` to either side.
    pub fn new(stiffness: f64, play: f64) -> Self {
        Self {
            stiffness,
            compliance: stiffness.recip(),
            play,
        }
    }

    /// Whether it holds nothing anywhere.
    pub fn has_play(&self) -> bool {
        self.play > 0.0
    }

    /// How far it has given way when it bears `load`, on the side to which that pushes.
    pub fn way(&self, load: f64) -> f64 {
        load * self.compliance + self.play.copysign(load)
    }

    /// How much farther it gives way for so much more `load`.
    pub fn way_over(&self, load: f64) -> f64 {
        load * self.compliance
    }

    /// By how much its load changes over `way` beyond the play, without sign.
    pub fn load_over(&self, way: f64) -> f64 {
        self.stiffness * way.abs()
    }

    /// Whether it can bear a load that pushes as `load` does, its play used up at `at`.
    pub fn holds(&self, at: f64, load: f64) -> bool {
        self.play == 0.0 || at * load.signum() >= self.play
    }

    /// A Newton step from `at` to where it bears the `load` that pushes there, which falls by `stiffness` as it gives way; but over
    /// no end of the play: there its own stiffness changes.
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
        // Back from beyond the other end.
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

    /// Where a spring beyond a play settles that a softer spring pulls at, whose far end is at `drive`.
    fn settled(spring: &PlaySpring, from: f64, stiffness: f64, drive: f64) -> f64 {
        (0..4).fold(from, |at, _| {
            spring.give(at, stiffness * (drive - at), stiffness)
        })
    }

    #[test]
    fn a_spring_with_play_settles_where_the_loads_balance_from_anywhere() {
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
                // Rounding: Newton's steps are exact on a piecewise straight line.
                assert!((at - expected).abs() < 1e-15, "{at} from {from} to {drive}");
            }
        }
    }

    #[test]
    fn a_bottle_that_nothing_touches_stays_within_its_play() {
        let spring = PlaySpring::new(50.0, 0.2);
        assert_eq!(spring.give(0.13, 0.0, 0.0), 0.13);
        assert_eq!(spring.give(-0.2, 0.0, 0.0), -0.2);
        assert!((spring.give(0.3, 0.0, 0.0) - 0.2).abs() < 1e-15);
        assert!((spring.give(-0.3, 0.0, 0.0) + 0.2).abs() < 1e-15);
    }
}
