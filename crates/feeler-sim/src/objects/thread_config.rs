//! Parameters of threads and hinges in an experiment file, and the resistance of a thread.

use feeler::check::{Checker, MAX};
use serde::{Deserialize, Serialize};

/// The thread of a cap, and its seat.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ThreadConfig {
    /// Torque that keeps the cap turning before it is seated (N·m).
    pub running_torque: f64,
    /// Angle by which the cap turns before it reaches its seat (rad). Negative if it starts tightened onto its seat.
    pub seat_angle: f64,
    /// Increase of the resisting torque per radian that the cap turns beyond its seat (N·m/rad).
    pub seat_stiffness: f64,
    /// Ratio of the breakaway torque to the torque that keeps the cap turning, at least 1.
    pub static_factor: f64,
    /// Descent per turn (m).
    pub lead: f64,
    /// Defect of the thread, if any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fault: Option<ThreadFault>,
}

/// Defect of a thread.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ThreadFault {
    /// The cap never seats and can be turned without end.
    Stripped,
    /// The cap is askew and jams on the bottle's thread: the resisting torque rises before the seat.
    CrossThreaded {
        /// Angle at which the cap starts to jam (rad).
        angle: f64,
        /// Increase of the resisting torque per radian beyond this angle (N·m/rad); lower than that of a seat.
        stiffness: f64,
    },
}

/// A hinge with friction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HingeConfig {
    /// Torque that keeps the hinge turning (N·m).
    #[serde(default)]
    pub running_torque: f64,
    /// Ratio of the breakaway torque to the torque that keeps the hinge turning, at least 1.
    #[serde(default = "one")]
    pub static_factor: f64,
}

fn one() -> f64 {
    1.0
}

impl HingeConfig {
    /// Checks that every value of the table `key` is in its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        checker.not_negative(&format!("{key}.running_torque"), self.running_torque);
        let factor = self.static_factor;
        checker.between(&format!("{key}.static_factor"), factor, 1.0, 10.0);
    }
}

impl ThreadConfig {
    /// Checks that every value of the table `key` is in its range.
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

    /// Torque that resists turning at `angle` (rad) while the cap turns (N·m).
    pub fn resisting_torque(&self, angle: f64) -> f64 {
        let stops = self.stops().into_iter();
        let rise = stops.map(|(met, stiffness)| stiffness * (angle - met).max(0.0));
        self.running_torque + rise.sum::<f64>()
    }

    /// Slope of the resisting torque in the direction of `torque` (N·m/rad). When a seated cap is opened the resistance
    /// falls; a slope of 0 then keeps the Newton steps stable.
    pub(crate) fn resistance_slope(&self, angle: f64, torque: f64) -> f64 {
        let met = |(at, stiffness)| if angle >= at { stiffness } else { 0.0 };
        match torque > 0.0 {
            true => self.stops().into_iter().map(met).sum(),
            false => 0.0,
        }
    }

    /// Angles (rad) at which the seat and a jam begin, each with the increase of the torque per radian beyond it
    /// (N·m/rad).
    fn stops(&self) -> [(f64, f64); 2] {
        let seat = (self.seat_angle, self.seat_stiffness);
        match self.fault {
            None => [seat, (0.0, 0.0)],
            Some(ThreadFault::Stripped) => [(0.0, 0.0); 2],
            Some(ThreadFault::CrossThreaded { angle, stiffness }) => [seat, (angle, stiffness)],
        }
    }
}
