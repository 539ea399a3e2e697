//! Range checks of the table `[drives]`.

use super::DrivesConfig;
use super::shared::ServoIds;
use crate::error::thetas;
use crate::packet::Protocol;
use crate::registers::WATCHDOG_UNIT;
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
            counted(actual, "finger"),
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
            Protocol::Feetech | Protocol::FeetechScs => {
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
            checker.require(
                &key,
                counted(actual, "joint"),
                actual == expected,
                &format!("{}, {}", counted(expected, "joint"), thetas(expected)),
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

/// A number of things as text, e.g. "2 joints".
fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}
