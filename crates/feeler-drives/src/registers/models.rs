//! Known servo models.
//!
//! Model numbers, units, default velocity limits and stall torques are from the e-Manual's page of each model, e.g.
//! <https://emanual.robotis.com/docs/en/dxl/x/xc330-m288/>. Firmware versions for fast sync reads are from its page on
//! the protocol, <https://emanual.robotis.com/docs/en/dxl/protocol2/#fast-sync-read-0x8a>. The SCS0009 is as in its
//! product specification, <https://pages.switch-science.com/comparison/files/feetech/serial-scs/SCS0009_datasheet.pdf>.

use crate::packet::Protocol;
use std::f64::consts::TAU;

/// A servo model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Model {
    /// Name as in an experiment file.
    pub name: &'static str,
    /// Model number reported by the servo.
    pub number: i64,
    /// Protocol.
    pub protocol: Protocol,
    /// Number of positions over `range`.
    pub counts: i64,
    /// Angle of the horn that `counts` cover, rad: a turn, or the range of a potentiometer.
    pub range: f64,
    /// Unit of velocity, rad/s.
    pub velocity_unit: f64,
    /// Unit of current, A. Zero if the servo measures no current.
    pub current_unit: f64,
    /// Maximum velocity, in the model's unit of velocity. A Dynamixel's is the default of its register.
    pub velocity_limit: i64,
    /// Torque (N m) and current (A) of the stalled motor at its nominal voltage.
    pub stall: (f64, f64),
    /// First firmware with fast sync reads, or `None` if not supported.
    pub fast_sync_firmware: Option<i64>,
}

/// Unit of velocity of the X series: 0.229 rpm.
const X_SERIES: f64 = 0.229 * TAU / 60.0;

/// A servo of the X330 series: current in mA, fast sync reads from firmware 46.
const fn x330(name: &'static str, number: i64, limit: i64, stall: (f64, f64)) -> Model {
    Model {
        name,
        number,
        protocol: Protocol::Dynamixel,
        counts: 4096,
        range: TAU,
        velocity_unit: X_SERIES,
        current_unit: 0.001,
        velocity_limit: limit,
        stall,
        fast_sync_firmware: Some(46),
    }
}

/// A servo of the XM430 series: fast sync reads from firmware 45.
const fn xm430(name: &'static str, number: i64, limit: i64, stall: (f64, f64)) -> Model {
    Model {
        current_unit: 0.00269,
        fast_sync_firmware: Some(45),
        ..x330(name, number, limit, stall)
    }
}

/// All known models.
pub const MODELS: &[Model] = &[
    x330("XL330-M077", 1190, 1620, (0.215, 1.47)),
    x330("XL330-M288", 1200, 445, (0.52, 1.47)),
    x330("XC330-T181", 1210, 510, (0.76, 0.80)),
    x330("XC330-T288", 1220, 320, (0.92, 0.80)),
    x330("XC330-M181", 1230, 545, (0.60, 1.80)),
    x330("XC330-M288", 1240, 350, (0.93, 1.80)),
    xm430("XM430-W350", 1020, 200, (4.1, 2.3)),
    xm430("XM430-W210", 1030, 330, (3.0, 2.3)),
    Model {
        name: "STS3215",
        number: 777,
        protocol: Protocol::Feetech,
        counts: 4096,
        range: TAU,
        // One count per second.
        velocity_unit: TAU / 4096.0,
        current_unit: 0.0065,
        velocity_limit: 3400,
        // 30 kg cm at 12 V; the current is the largest value that its register for the limit accepts, 500.
        stall: (2.94, 3.25),
        fast_sync_firmware: None,
    },
    Model {
        name: "SCS0009",
        number: 1284,
        protocol: Protocol::FeetechScs,
        counts: 1024,
        range: SCS_RANGE,
        // One count per second.
        velocity_unit: SCS_RANGE / 1024.0,
        current_unit: 0.0,
        // 0.1 s for 60 degrees at 6 V.
        velocity_limit: 2048,
        // 2.3 kg cm at 6 V.
        stall: (0.226, 1.0),
        fast_sync_firmware: None,
    },
];

/// Range of an SCS servo: 300 degrees.
const SCS_RANGE: f64 = TAU / 1.2;

impl Model {
    /// Returns the model called `name`, or `None` if unknown.
    pub fn named(name: &str) -> Option<&'static Self> {
        MODELS.iter().find(|model| model.name == name)
    }

    /// Returns the model with this `protocol` and model `number`, or `None` if unknown.
    pub fn numbered(protocol: Protocol, number: i64) -> Option<&'static Self> {
        let known = |model: &&Self| model.protocol == protocol && model.number == number;
        MODELS.iter().find(known)
    }

    /// Converts a position in counts to the angle of the horn, rad.
    pub fn to_angle(&self, counts: f64) -> f64 {
        counts * self.range / self.counts as f64
    }

    /// Converts an angle of the horn (rad) to a position in counts.
    pub fn to_counts(&self, angle: f64) -> f64 {
        angle * self.counts as f64 / self.range
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Velocity units from the e-Manual (0.229 rpm) and from Feetech's table (50 counts per second = 0.732 rpm).
    #[test]
    fn velocity_units_equal_the_vendors() {
        let rpm = |name: &str| Model::named(name).expect(name).velocity_unit * 60.0 / TAU;
        assert!((rpm("XL330-M288") - 0.229).abs() < 1e-12);
        assert!((50.0 * rpm("STS3215") - 0.732).abs() < 1e-3);
    }

    /// The SCS0009 turns at 100 rpm without load, and its middle position is at 150 degrees.
    #[test]
    fn an_scs0009_has_the_units_of_its_specification() {
        let model = Model::named("SCS0009").expect("a model");
        let rpm = model.velocity_limit as f64 * model.velocity_unit * 60.0 / TAU;
        assert!((rpm - 100.0).abs() < 1e-9, "{rpm}");
        assert!((model.to_angle(512.0).to_degrees() - 150.0).abs() < 1e-9);
        assert!((model.to_counts(model.to_angle(77.0)) - 77.0).abs() < 1e-9);
    }
}
