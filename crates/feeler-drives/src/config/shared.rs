//! Checks of servos that move joints of several fingers.

use super::JointDriveConfig;
use super::check_joint::refuse_given;
use feeler::check::Checker;

/// Joints checked so far: id of the servo, finger, and `true` if the servo is shared.
#[derive(Default)]
pub(super) struct ServoIds(Vec<(u8, usize, bool)>);

impl ServoIds {
    /// Checks the id (`field`) of the servo of a joint of `finger`.
    pub fn check(
        &mut self,
        field: &str,
        finger: usize,
        joint: &JointDriveConfig,
        checker: &mut Checker,
    ) {
        let (id, shared) = (joint.id, joint.shared);
        let mut known = self.0.iter().filter(|known| known.0 == id);
        let (good, expected) = match shared {
            false => (
                known.all(|known| known.2),
                "an id that no other joint uses; if one servo moves both, set shared = true for the later one",
            ),
            true => (
                known.clone().any(|known| !known.2) && known.all(|known| known.1 < finger),
                "the id of a servo of an earlier finger, because shared = true (at most one joint per finger)",
            ),
        };
        checker.require(field, id.to_string(), good, expected);
        self.0.push((id, finger, shared));
    }
}

impl JointDriveConfig {
    /// Checks a joint with a shared servo, except for the transmission: the servo's settings belong to its first joint.
    pub(super) fn check_shared(&self, key: &str, checker: &mut Checker) {
        self.check_position(key, checker);
        let number = |value: Option<f64>| value.map(|value| value.to_string());
        let model = (!self.model.is_empty()).then(|| format!("{:?}", self.model));
        let mode = self.mode.map(|mode| format!("{:?}", mode.name()));
        let given = [
            ("model", model),
            ("mode", mode),
            ("leash", number(self.leash)),
            ("current_limit", number(self.current_limit)),
            ("torque_limit", number(self.torque_limit)),
            ("torque", self.torque.map(|_| "a calibration".into())),
        ];
        let expected = "no value with shared = true; set it at the first joint of the servo";
        refuse_given(key, given, expected, checker);
    }
}
