//! The kinds of servos that are known.
//!
//! Model numbers, units and velocity limits as they come: the e-Manual's page of each model, e.g.
//! <https://emanual.robotis.com/docs/en/dxl/x/xc330-m288/>. Fast sync reads: its page of the protocol,
//! <https://emanual.robotis.com/docs/en/dxl/protocol2/#fast-sync-read-0x8a>.

use super::COUNTS_PER_TURN;
use crate::packet::Protocol;
use std::f64::consts::TAU;

/// A kind of servo.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Model {
    /// Its name, as in an experiment file.
    pub name: &'static str,
    /// What it says that it is.
    pub number: i64,
    /// What it speaks.
    pub protocol: Protocol,
    /// Its unit of velocity, rad/s.
    pub velocity_unit: f64,
    /// Its unit of current, A.
    pub current_unit: f64,
    /// Its greatest velocity as it comes, in its unit: for the emulator.
    pub velocity_limit: i64,
    /// The first firmware that answers fast sync reads, if one does.
    pub fast_sync_firmware: Option<i64>,
}

/// 0.229 revolutions a minute.
const X_SERIES: f64 = 0.229 * TAU / 60.0;

/// A servo of the X330 series: a milliampere to a unit of current, and fast sync reads from firmware 46 on.
const fn x330(name: &'static str, number: i64, limit: i64) -> Model {
    Model {
        name,
        number,
        protocol: Protocol::Dynamixel,
        velocity_unit: X_SERIES,
        current_unit: 0.001,
        velocity_limit: limit,
        fast_sync_firmware: Some(46),
    }
}

/// A servo of the XM430 series, with fast sync reads from firmware 45 on.
const fn xm430(name: &'static str, number: i64, limit: i64) -> Model {
    Model {
        current_unit: 0.00269,
        fast_sync_firmware: Some(45),
        ..x330(name, number, limit)
    }
}

/// The models that are known.
pub const MODELS: &[Model] = &[
    x330("XL330-M077", 1190, 1620),
    x330("XL330-M288", 1200, 445),
    x330("XC330-T181", 1210, 510),
    x330("XC330-T288", 1220, 320),
    x330("XC330-M181", 1230, 545),
    x330("XC330-M288", 1240, 350),
    xm430("XM430-W350", 1020, 200),
    xm430("XM430-W210", 1030, 330),
    Model {
        name: "STS3215",
        number: 777,
        protocol: Protocol::Feetech,
        // A count a second.
        velocity_unit: TAU / COUNTS_PER_TURN,
        current_unit: 0.0065,
        velocity_limit: 3400,
        fast_sync_firmware: None,
    },
];

impl Model {
    /// The model called `name`.
    pub fn named(name: &str) -> Option<&'static Self> {
        MODELS.iter().find(|model| model.name == name)
    }

    /// The model that says it is `number` and speaks `protocol`.
    pub fn numbered(protocol: Protocol, number: i64) -> Option<&'static Self> {
        let known = |model: &&Self| model.protocol == protocol && model.number == number;
        MODELS.iter().find(known)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Velocities of the e-Manual and of Feetech's table: 0.229 rpm, and 50 counts a second = 0.732 rpm.
    #[test]
    fn units_are_the_vendors() {
        let rpm = |name: &str| Model::named(name).expect(name).velocity_unit * 60.0 / TAU;
        assert!((rpm("XL330-M288") - 0.229).abs() < 1e-12);
        assert!((50.0 * rpm("STS3215") - 0.732).abs() < 1e-3);
    }
}
