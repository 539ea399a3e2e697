//! Threads and hinges, as an experiment file describes them, and how a thread resists.

use feeler::check::{Checker, MAX};
use serde::{Deserialize, Serialize};

/// The thread and the seat under a cap.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ThreadConfig {
    /// Torque that turns the cap before it is seated, N·m.
    pub running_torque: f64,
    /// Angle by which the cap turns before it meets its seat, rad; negative where it starts on its seat, tightened by so much.
    pub seat_angle: f64,
    /// Rise of the resisting torque once the cap is on its seat, N·m/rad.
    pub seat_stiffness: f64,
    /// Torque that sets the cap going, relative to the torque that keeps it going, at least 1.
    pub static_factor: f64,
    /// Descent per turn, m.
    pub lead: f64,
    /// What is wrong with it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fault: Option<ThreadFault>,
}

/// What may be wrong with a thread.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ThreadFault {
    /// Nothing seats the cap: it turns for ever.
    Stripped,
    /// The cap sits askew: its thread rides up on the bottle's, and the resisting torque rises before the seat.
    CrossThreaded {
        /// Angle at which it begins to jam, rad.
        angle: f64,
        /// Rise of the resisting torque from there, N·m/rad. Crossed threads give way where a seat does not.
        stiffness: f64,
    },
}

/// A hinge with friction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HingeConfig {
    /// Torque that keeps it turning, N·m.
    #[serde(default)]
    pub running_torque: f64,
    /// Torque that sets it going, relative to the torque that keeps it going, at least 1.
    #[serde(default = "one")]
    pub static_factor: f64,
}

fn one() -> f64 {
    1.0
}

impl ThreadConfig {
    /// Requires every value of the table `key` to be in its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        checker.between(&format!("{key}.seat_angle"), self.seat_angle, -10.0, MAX);
        if let Some(ThreadFault::CrossThreaded { angle, stiffness }) = &self.fault {
            let key = format!("{key}.fault.cross_threaded");
            checker.between(&format!("{key}.angle"), *angle, -10.0, MAX);
            checker.positive(&format!("{key}.stiffness"), *stiffness);
        }
        let not_negative = [
            ("running_torque", self.running_torque),
            ("seat_stiffness", self.seat_stiffness),
            ("lead", self.lead),
        ];
        for (field, value) in not_negative {
            checker.not_negative(&format!("{key}.{field}"), value);
        }
        let factor = self.static_factor;
        checker.between(&format!("{key}.static_factor"), factor, 1.0, 10.0);
    }
}

impl HingeConfig {
    /// Requires every value of the table `key` to be in its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        checker.not_negative(&format!("{key}.running_torque"), self.running_torque);
        let factor = self.static_factor;
        checker.between(&format!("{key}.static_factor"), factor, 1.0, 10.0);
    }
}

impl ThreadConfig {
    /// Torque that resists turning at `angle` (rad) while the cap turns, N·m.
    pub fn resisting_torque(&self, angle: f64) -> f64 {
        let stops = self.stops().into_iter();
        let rise = stops.map(|(met, stiffness)| stiffness * (angle - met).max(0.0));
        self.running_torque + rise.sum::<f64>()
    }

    /// Rise of the resisting torque per angle in the direction of `torque`. A seated cap that comes
    /// loose meets less and less resistance; counting that as 0 keeps the steps stable.
    pub(super) fn resistance_slope(&self, angle: f64, torque: f64) -> f64 {
        let met = |(at, stiffness)| if angle >= at { stiffness } else { 0.0 };
        match torque > 0.0 {
            true => self.stops().into_iter().map(met).sum(),
            false => 0.0,
        }
    }

    /// What stops the cap: the angle (rad) at which it meets each, and the rise of the torque from there, N·m/rad.
    fn stops(&self) -> [(f64, f64); 2] {
        let seat = (self.seat_angle, self.seat_stiffness);
        match self.fault {
            None => [seat, (0.0, 0.0)],
            Some(ThreadFault::Stripped) => [(0.0, 0.0); 2],
            Some(ThreadFault::CrossThreaded { angle, stiffness }) => [seat, (angle, stiffness)],
        }
    }
}
