//! Range checks of the table `[drives]`.

use super::shared::ServoIds;
use super::{DrivesConfig, JointDriveConfig};
use crate::error::thetas;
use crate::packet::Protocol;
use crate::registers::{DriveMode, MODELS, WATCHDOG_UNIT};
use feeler::check::Checker;

/// Maximum timeout of a Dynamixel's bus watchdog, s.
const LONGEST_WATCHDOG: f64 = 127.0 * WATCHDOG_UNIT;
impl DrivesConfig {
    /// Checks that every value of the table `key` is in its range. `prismatic` has an entry per joint of each finger of
    /// the hand: `true` if the joint is prismatic.
    pub fn check(&self, key: &str, prismatic: &[Vec<bool>], checker: &mut Checker) {
        let fingers = prismatic.len();
        let field = |field: &str| format!("{key}.{field}");
        let port = &self.port;
        checker.require(
            &field("port"),
            format!("{port:?}"),
            !port.is_empty(),
            "the name of a serial port",
        );
        checker.between(&field("baud_rate"), self.baud_rate.into(), 9600.0, 1e7);
        self.check_protocol(key, checker);
        checker.between(&field("reply_timeout"), self.reply_timeout, 1e-4, 1.0);
        checker.between(&field("health_interval"), self.health_interval, 1e-3, 10.0);
        checker.between(
            &field("temperature_limit_celsius"),
            self.temperature_limit_celsius,
            30.0,
            100.0,
        );
        let [low, high] = self.voltage_range;
        checker.require(
            &field("voltage_range"),
            format!("[{low}, {high}]"),
            0.0 < low && low < high && high <= 60.0,
            "[lowest, highest] in V, above 0 and at most 60",
        );
        checker.between(&field("limit_tolerance"), self.limit_tolerance, 0.0, 1.0);
        let actual = self.finger.len();
        checker.require(
            &field("finger"),
            format!("{actual} fingers"),
            actual == fingers,
            &format!("as many fingers as hand.finger ({fingers})"),
        );
        self.check_joints(key, prismatic, checker);
    }

    fn check_protocol(&self, key: &str, checker: &mut Checker) {
        let (field, value) = (format!("{key}.bus_watchdog"), self.bus_watchdog);
        match self.protocol {
            Protocol::Dynamixel => {
                checker.between(&field, value, WATCHDOG_UNIT, LONGEST_WATCHDOG);
            }
            Protocol::Feetech => {
                let expected = "0: Feetech servos have no watchdog, so their motors keep running if the computer fails";
                checker.require(&field, value.to_string(), value == 0.0, expected);
                checker.require(
                    &format!("{key}.fast_sync_read"),
                    self.fast_sync_read.to_string(),
                    !self.fast_sync_read,
                    "false: Feetech servos do not support fast sync reads",
                );
            }
        }
    }

    fn check_joints(&self, key: &str, prismatic: &[Vec<bool>], checker: &mut Checker) {
        let mut ids = ServoIds::default();
        for (finger, drives) in self.finger.iter().enumerate() {
            let key = format!("{key}.finger[{finger}].joint");
            let actual = drives.joint.len();
            let prismatic = prismatic.get(finger).map_or(&[false; 3][..], Vec::as_slice);
            let expected = prismatic.len();
            let plural = if expected == 1 { "" } else { "s" };
            checker.require(
                &key,
                format!("{actual} joints"),
                actual == expected,
                &format!("{expected} joint{plural}, {}", thetas(expected)),
            );
            for (index, joint) in drives.joint.iter().enumerate() {
                let key = format!("{key}[{index}]");
                let is_prismatic = prismatic.get(index) == Some(&true);
                match joint.shared {
                    true => joint.check_shared(&key, checker),
                    false => joint.check_servo(&key, self.protocol, checker),
                }
                joint.check_transmission(&key, is_prismatic, checker);
                ids.check(&format!("{key}.id"), finger, joint, checker);
            }
        }
    }
}

impl JointDriveConfig {
    /// Checks a servo and its first joint, except for the transmission.
    fn check_servo(&self, key: &str, protocol: Protocol, checker: &mut Checker) {
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
            &format!("one of {}", names.join(", ")),
        );
        self.check_position(key, checker);
        if let Some(limit) = self.current_limit {
            checker.between(&field("current_limit"), limit, 0.01, 10.0);
        }
        self.check_mode(key, checker);
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
        let (mode, name) = (self.mode, self.mode.name());
        if let Some(leash) = self.leash {
            checker.between(&field("leash"), leash, 1e-5, 1.0);
            let expected = "none in velocity mode";
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
            "current_limit, or torque_limit and torque, beside this mode",
        );
        if let Some(limit) = self.torque_limit {
            checker.between(&field("torque_limit"), limit, 1e-3, 1000.0);
            let has_torque = self.torque.is_some();
            let expected = "torque beside torque_limit; see `feeler drives identify-current`";
            checker.require(
                &field("torque_limit"),
                limit.to_string(),
                has_torque,
                expected,
            );
        }
        if let Some(torque) = self.torque {
            let field = |name: &str| field(&format!("torque.{name}"));
            checker.between(&field("constant"), torque.constant, 1e-3, 1e4);
            checker.between(&field("constant_error"), torque.constant_error, 0.0, 1e4);
            checker.between(&field("friction"), torque.friction, 0.0, 1e3);
            checker.between(&field("friction_error"), torque.friction_error, 0.0, 1e3);
        }
    }

    /// Checks that the keys of the transmission between servo and joint match the kind of joint.
    fn check_transmission(&self, key: &str, is_prismatic: bool, checker: &mut Checker) {
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
                    "1 beside travel_per_turn, which includes any gear",
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
