//! Bus time required per control period.

use super::DrivesConfig;
use crate::bus::BITS_PER_BYTE;
use crate::packet::{Protocol, fast_status_length};
use crate::registers::{GoalKind, Registers, TORQUE_TO_WATCHDOG, VOLTAGE_TO_TEMPERATURE};
use feeler::check::Checker;

impl DrivesConfig {
    /// Checks that all servos can be read and commanded within a control `period` (s), and that the time of their
    /// watchdogs, unless it is 0 (disabled), is longer than `period`.
    pub fn check_period(&self, key: &str, period: f64, checker: &mut Checker) {
        let needed = self.bus_time();
        checker.require(
            &format!("{key}.baud_rate"),
            self.baud_rate.to_string(),
            needed <= period,
            &format!(
                "a bus that transfers the packets of a period within control.period = {period} s, got {needed:.6} s; raise baud_rate, here and in the servos, or control.period"
            ),
        );
        checker.require(
            &format!("{key}.bus_watchdog"),
            self.bus_watchdog.to_string(),
            self.bus_watchdog == 0.0 || self.bus_watchdog > period,
            &format!("more than control.period = {period} s, the time between commands"),
        );
    }

    /// Maximum time for which the packets of a control period occupy the bus, s: reading and commanding all servos, and
    /// querying the health of one. Excludes byte stuffing and the delays of servos and adapter.
    pub fn bus_time(&self) -> f64 {
        let bytes = self.reading_bytes() + self.goal_bytes() + self.health_bytes();
        bytes as f64 * BITS_PER_BYTE / f64::from(self.baud_rate)
    }

    /// Part of the control table read in every period: address of the first byte, and number of bytes.
    pub(crate) fn motion_part(&self) -> (u16, usize) {
        let registers = Registers::of(self.protocol);
        match self.reads_current() {
            true => registers.motion_and_current,
            false => registers.motion,
        }
    }

    /// Number of bytes of the exchange that reads all servos.
    fn reading_bytes(&self) -> usize {
        let (protocol, servos) = (self.protocol, self.servos().count());
        let (_, length) = self.motion_part();
        if !protocol.has_sync_read() {
            return servos * read_bytes(protocol, length);
        }
        let request = instruction_bytes(protocol, part_bytes(protocol) + servos);
        request
            + match self.fast_sync_read {
                true => fast_status_length(servos, length),
                false => servos * protocol.status_length(length),
            }
    }

    /// Number of bytes of the sync writes of all goals.
    fn goal_bytes(&self) -> usize {
        let registers = Registers::of(self.protocol);
        let of_kind = |kind: GoalKind| {
            let servos = self.servos().filter(|servo| servo.mode().goal() == kind);
            match servos.count() {
                0 => 0,
                servos => {
                    let goals = servos * (1 + registers.goal(kind).length);
                    instruction_bytes(self.protocol, part_bytes(self.protocol) + goals)
                }
            }
        };
        GoalKind::ALL.into_iter().map(of_kind).sum()
    }

    /// Number of bytes of a query of a servo's health.
    fn health_bytes(&self) -> usize {
        let protocol = self.protocol;
        match protocol {
            Protocol::Dynamixel => [TORQUE_TO_WATCHDOG, VOLTAGE_TO_TEMPERATURE]
                .map(|(_, length)| read_bytes(protocol, length))
                .iter()
                .sum(),
            Protocol::Feetech | Protocol::FeetechScs => {
                read_bytes(protocol, Registers::of(protocol).torque.length)
            }
        }
    }
}

/// Number of bytes of a read of `length` bytes from one servo, with its response.
fn read_bytes(protocol: Protocol, length: usize) -> usize {
    instruction_bytes(protocol, part_bytes(protocol)) + protocol.status_length(length)
}

/// Number of bytes of an instruction with this number of bytes of parameters.
fn instruction_bytes(protocol: Protocol, parameters: usize) -> usize {
    protocol.before_parameters() + parameters + protocol.check_length()
}

/// Number of bytes that name a part of the control table: its address and length.
fn part_bytes(protocol: Protocol) -> usize {
    match protocol {
        Protocol::Dynamixel => 4,
        Protocol::Feetech | Protocol::FeetechScs => 2,
    }
}
