//! Range checks of a servo and its joints.

use super::JointDriveConfig;
use crate::packet::Protocol;
use crate::registers::{DriveMode, MODELS};
use feeler::check::Checker;

impl JointDriveConfig {
    /// Checks a servo and its first joint, except for the transmission.
    pub(super) fn check_servo(&self, key: &str, protocol: Protocol, checker: &mut Checker) {
        let field = |field: &str| format!("{key}.{field}");
        checker.between(
            &field("id"),
            self.id.into(),
            0.0,
            protocol.largest_id().into(),
        );
        let known = MODELS.iter().filter(|model| model.protocol == protocol);
        let names: Vec<_> = known.map(|model| model.name).collect();
        checker.require(
            &field("model"),
            format!("{:?}", self.model),
            names.contains(&self.model.as_str()),
            &format!(
                "one of {} for protocol = {:?}",
                names.join(", "),
                protocol.name()
            ),
        );
        self.check_position(key, checker);
        if let Some(limit) = self.current_limit {
            checker.between(&field("current_limit"), limit, 0.01, 10.0);
        }
        self.check_mode(key, checker);
        if protocol == Protocol::FeetechScs {
            self.check_scs(key, checker);
        }
    }

    /// Checks that the servo has only settings that servos of the SCS series support.
    fn check_scs(&self, key: &str, checker: &mut Checker) {
        let field = |field: &str| format!("{key}.{field}");
        let mode = self.mode();
        checker.require(
            &field("mode"),
            format!("{:?}", mode.name()),
            DriveMode::supported(Protocol::FeetechScs).contains(&mode),
            "\"position\", the only mode of SCS servos",
        );
        let number = |value: Option<f64>| value.map(|value| value.to_string());
        let given = [
            ("current_limit", number(self.current_limit)),
            ("torque_limit", number(self.torque_limit)),
            ("torque", self.torque.map(|_| "a calibration".into())),
        ];
        let expected = "no value: SCS servos measure no current";
        refuse_given(key, given, expected, checker);
    }

    /// Checks zero and direction of the joint.
    pub(super) fn check_position(&self, key: &str, checker: &mut Checker) {
        let field = |field: &str| format!("{key}.{field}");
        checker.between(&field("homing_offset"), self.homing_offset, -1e4, 1e4);
        checker.require(
            &field("direction"),
            self.direction.to_string(),
            self.direction.abs() == 1,
            "1 or -1",
        );
    }

    /// Checks that the mode has the keys that it requires.
    fn check_mode(&self, key: &str, checker: &mut Checker) {
        let field = |field: &str| format!("{key}.{field}");
        let (mode, name) = (self.mode(), self.mode().name());
        if let Some(leash) = self.leash {
            checker.between(&field("leash"), leash, 1e-5, 1.0);
            let expected = "no value in velocity mode; remove it, or set a position mode";
            checker.require(
                &field("leash"),
                leash.to_string(),
                mode != DriveMode::Velocity,
                expected,
            );
        }
        checker.require(
            &field("mode"),
            format!("{name:?}"),
            mode != DriveMode::CurrentLimitedPosition || self.most_current().is_some(),
            "current-limited-position only with current_limit, or with torque_limit and torque",
        );
        if let Some(limit) = self.torque_limit {
            checker.between(&field("torque_limit"), limit, 1e-3, 1000.0);
            let has_torque = self.torque.is_some();
            let expected =
                "torque_limit only with torque; determine it with `feeler drives identify-current`";
            checker.require(
                &field("torque_limit"),
                limit.to_string(),
                has_torque,
                expected,
            );
            checker.require(
                &field("torque_limit"),
                limit.to_string(),
                mode == DriveMode::CurrentLimitedPosition,
                "no value in this mode; remove it, or set mode = \"current-limited-position\"",
            );
            self.check_torque_limit(&field("torque_limit"), limit, checker);
        }
        if let Some(torque) = self.torque {
            let field = |name: &str| field(&format!("torque.{name}"));
            checker.between(&field("constant"), torque.constant, 1e-3, 1e4);
            checker.between(&field("constant_error"), torque.constant_error, 0.0, 1e4);
            checker.between(&field("friction"), torque.friction, 0.0, 1e3);
            checker.between(&field("friction_error"), torque.friction_error, 0.0, 1e3);
        }
    }

    /// Checks that the motor can exert a torque `limit` that determines its current. A greater one would limit nothing.
    fn check_torque_limit(&self, field: &str, limit: f64, checker: &mut Checker) {
        let (Some(model), Some(torque), Some(current)) =
            (self.known_model(), self.torque, self.most_current())
        else {
            return;
        };
        let (_, stall_current) = model.stall;
        let (most, name) = (torque.constant * stall_current, model.name);
        checker.require(
            field,
            limit.to_string(),
            current <= stall_current,
            &format!("at most {most:.3}, torque.constant times the stall current of model {name} ({stall_current} A)"),
        );
    }

    /// Checks that the keys of the transmission between servo and joint match the kind of joint.
    pub(super) fn check_transmission(&self, key: &str, is_prismatic: bool, checker: &mut Checker) {
        let field = |field: &str| format!("{key}.{field}");
        if !is_prismatic {
            checker.between(&field("gear_ratio"), self.gear_ratio, 0.01, 1000.0);
        }
        match self.travel_per_turn {
            None => checker.require(
                key,
                "a servo without travel_per_turn".into(),
                !is_prismatic,
                "travel_per_turn in m, as the joint is prismatic",
            ),
            Some(travel) if is_prismatic => {
                checker.between(&field("travel_per_turn"), travel, 1e-4, 1.0);
                checker.require(
                    &field("gear_ratio"),
                    self.gear_ratio.to_string(),
                    self.gear_ratio == 1.0,
                    "1 with travel_per_turn, which includes any gear",
                );
            }
            Some(travel) => checker.require(
                &field("travel_per_turn"),
                travel.to_string(),
                false,
                "none, as the joint is revolute; use gear_ratio",
            ),
        }
    }
}

/// Reports an error for every field of `given` that has a value.
pub(super) fn refuse_given<const N: usize>(
    key: &str,
    given: [(&str, Option<String>); N],
    expected: &str,
    checker: &mut Checker,
) {
    for (field, value) in given {
        if let Some(value) = value {
            checker.require(&format!("{key}.{field}"), value, false, expected);
        }
    }
}
