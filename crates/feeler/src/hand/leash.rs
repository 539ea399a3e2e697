//! Goal positions that follow a velocity on a leash.

/// A goal position (rad or m) that integrates the velocity of its joint. It stays within a leash of the measured position,
/// so that a stalled joint never winds up, and moves no faster than the joint's speed limit, so that an error of the
/// encoder does not become a jump. Moves only by the time between measurements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeashedGoal {
    /// Goal position.
    pub position: f64,
    /// Maximum distance from the measured position.
    pub leash: f64,
    /// Limits of the joint's position.
    pub limits: (f64, f64),
    /// Speed limit of the joint.
    pub speed: f64,
}

impl LeashedGoal {
    /// Holds the joint where it stands.
    pub fn hold(&mut self, measured: f64) {
        self.position = measured;
    }

    /// Advances by `velocity` for a joint that was measured at `measured`, `elapsed` seconds after the previous measurement.
    /// Does not pass a limit of the joint, but may start beyond it. Zero velocity holds the goal.
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
