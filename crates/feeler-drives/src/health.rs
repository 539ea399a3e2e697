//! Health checks of servos.

use crate::config::DrivesConfig;
use crate::error::{DriveError, JointName};
use crate::packet::Protocol;
use crate::registers::{Register, Registers};

/// Fault bit of an overload, of all protocols.
pub(crate) const OVERLOAD: u8 = 0x20;

/// Health reported by a servo.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Health {
    /// Fault bits.
    pub fault: u8,
    /// Temperature, degrees Celsius.
    pub temperature: f64,
    /// Supply voltage, V.
    pub voltage: f64,
}

/// Limits of a servo's health.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HealthLimits {
    /// Maximum temperature, degrees Celsius.
    pub temperature: f64,
    /// Minimum and maximum supply voltage, V.
    pub voltage: [f64; 2],
}

impl DrivesConfig {
    /// Limits for the health of the servos.
    pub fn health_limits(&self) -> HealthLimits {
        HealthLimits {
            temperature: self.temperature_limit_celsius,
            voltage: self.voltage_range,
        }
    }
}

impl Health {
    /// Converts the values of the registers.
    pub(crate) fn of(fault: i64, temperature: i64, voltage: i64) -> Self {
        Self {
            fault: fault as u8,
            temperature: temperature as f64,
            voltage: voltage as f64 / 10.0,
        }
    }

    /// Decodes the health from the bytes of [`Registers::motion`]; meaningful only if [`Registers::motion_has_health`].
    /// `bytes` may contain further registers.
    pub fn in_motion(registers: &Registers, bytes: &[u8]) -> Self {
        let at = |register: Register| register.in_part(registers.motion.0, bytes);
        Self::of(
            at(registers.fault),
            at(registers.temperature),
            at(registers.voltage),
        )
    }

    /// Checks the health of the servo of `joint`.
    ///
    /// # Errors
    /// Returns the first problem: a reported fault, the temperature, or the supply voltage.
    pub fn check(
        &self,
        protocol: Protocol,
        joint: JointName,
        limits: &HealthLimits,
    ) -> Result<(), DriveError> {
        if self.fault != 0 {
            return Err(DriveError::Fault {
                joint,
                faults: fault_names(protocol, self.fault),
                bits: self.fault,
            });
        }
        if self.temperature > limits.temperature {
            return Err(DriveError::Temperature {
                joint,
                actual: self.temperature,
                limit: limits.temperature,
            });
        }
        let [low, high] = limits.voltage;
        if !(low..=high).contains(&self.voltage) {
            return Err(DriveError::Voltage {
                joint,
                actual: self.voltage,
                low,
                high,
            });
        }
        Ok(())
    }
}

/// Names of the fault bits of the X series (address 70) and of Feetech servos (address 65).
pub(crate) fn fault_names(protocol: Protocol, bits: u8) -> String {
    let names = match protocol {
        Protocol::Dynamixel => [
            "input voltage",
            "",
            "overheating",
            "motor encoder",
            "electrical shock",
            "overload",
            "",
            "",
        ],
        Protocol::Feetech | Protocol::FeetechScs => [
            "input voltage",
            "encoder",
            "overheating",
            "overcurrent",
            "",
            "overload",
            "",
            "",
        ],
    };
    let set = (0..8).filter(|bit| bits & (1 << bit) != 0);
    let named: Vec<_> = set
        .map(|bit| match names[bit] {
            "" => format!("bit {bit}"),
            name => name.to_string(),
        })
        .collect();
    named.join(", ")
}
