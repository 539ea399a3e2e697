//! Whether a servo is well, by what it says of itself.

use crate::config::DrivesConfig;
use crate::error::{DriveError, JointName};
use crate::packet::Protocol;
use crate::registers::Registers;

/// What a servo says of itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Health {
    /// Bits of its faults.
    pub fault: u8,
    /// Degrees Celsius.
    pub temperature: f64,
    /// Supply voltage, V.
    pub voltage: f64,
}

/// What is allowed of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HealthLimits {
    /// Degrees Celsius.
    pub temperature: f64,
    /// Lowest and highest supply voltage, V.
    pub voltage: [f64; 2],
}

impl DrivesConfig {
    /// What its servos may say of themselves.
    pub fn health_limits(&self) -> HealthLimits {
        HealthLimits {
            temperature: self.temperature_limit_celsius,
            voltage: self.voltage_range,
        }
    }
}

impl Health {
    /// What the bytes of [`Registers::motion`] say, where they say it.
    pub fn in_motion(registers: &Registers, bytes: &[u8]) -> Self {
        Self {
            fault: registers.in_motion(registers.fault, bytes) as u8,
            temperature: registers.in_motion(registers.temperature, bytes) as f64,
            voltage: registers.in_motion(registers.voltage, bytes) as f64 / 10.0,
        }
    }

    /// Requires the servo of `joint` to be well.
    ///
    /// # Errors
    /// What is wrong with it first: a fault that it reports, its temperature, its supply.
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

/// The faults of the X series (address 70) and of STS servos (address 65), from bit 0.
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
        Protocol::Feetech => [
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
