//! Goal positions of joints for position-controlled drives, with a limited distance from the measured position.

/// Goal position (rad or m) of a joint that integrates its commanded velocity. The distance from the measured position
/// is limited (leash), so that the goal does not wind up if the joint is stalled. The goal moves no faster than the
/// joint's speed limit, so that an encoder error does not cause a jump. Its motion is computed from the time between
/// measurements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeashedGoal {
    /// Goal position (rad or m).
    pub position: f64,
    /// Maximum distance of the goal from the measured position (rad or m).
    pub leash: f64,
    /// Lower and upper limit of the joint's position (rad or m).
    pub limits: (f64, f64),
    /// Maximum speed of the joint (rad/s or m/s).
    pub speed: f64,
}

impl LeashedGoal {
    /// Sets the goal to the `measured` position (rad or m), so that the joint holds it.
    pub fn hold(&mut self, measured: f64) {
        self.position = measured;
    }

    /// Advances the goal at `velocity` (rad/s or m/s). `measured` is the measured position (rad or m), `elapsed` the
    /// time since the previous measurement (s). The goal does not move beyond a limit of the joint, but may start
    /// beyond it. If the velocity is zero, the goal does not change.
    pub fn advance(&mut self, velocity: f64, elapsed: f64, measured: f64) {
        if velocity == 0.0 {
            return;
        }
        let before = self.position;
        let within = |goal: f64, low: f64, high: f64| goal.max(low).min(high);
        let (low, high) = (measured - self.leash, measured + self.leash);
        let leashed = within(before + velocity * elapsed, low, high);
        let most = self.speed * elapsed;
        let stepped = within(leashed, before - most, before + most);
        let (lower, upper) = self.limits;
        self.position = within(stepped, lower.min(before), upper.max(before));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const GOAL: LeashedGoal = LeashedGoal {
        position: 0.0,
        leash: 0.1,
        limits: (-1.0, 1.0),
        speed: 2.0,
    };

    #[test]
    fn a_stalled_joint_does_not_wind_up() {
        let mut goal = GOAL;
        for _ in 0..1000 {
            goal.advance(0.5, 0.01, 0.0);
        }
        assert_eq!(goal.position, 0.1);
        // It leaves the end of the leash with the first command in the other direction.
        goal.advance(-0.5, 0.01, 0.0);
        assert!((goal.position - 0.095).abs() < 1e-12, "{goal:?}");
        // A stop holds the goal.
        goal.advance(0.0, 0.01, -0.5);
        assert!((goal.position - 0.095).abs() < 1e-12, "{goal:?}");
    }

    #[test]
    fn a_jump_of_the_encoder_is_followed_at_the_speed_limit() {
        let mut goal = GOAL;
        goal.advance(0.5, 0.01, 0.8);
        assert_eq!(goal.position, 0.02);
    }

    proptest! {
        /// For any commands and measurements, the goal is no faster than the speed limit, never leads the joint by more
        /// than the leash in the commanded direction unless it did before, and never passes a limit.
        #[test]
        fn goals_stay_on_the_leash(steps in prop::collection::vec((-2.0..2.0f64, 0.0..0.05f64, -1.5..1.5f64), 1..50)) {
            let mut goal = GOAL;
            for (velocity, elapsed, measured) in steps {
                let before = goal.position;
                goal.advance(velocity, elapsed, measured);
                let moved = goal.position - before;
                prop_assert!(moved.abs() <= 2.0 * elapsed + 1e-12);
                let lead = (goal.position - measured) * velocity.signum();
                let led = (before - measured) * velocity.signum();
                prop_assert!(lead <= goal.leash.max(led) + 1e-12, "{} {}", lead, led);
                prop_assert!((-1.0..=1.0).contains(&goal.position));
            }
        }
    }
}
