//! Motion of an emulated servo in its operating mode.

use super::{EmulatedServo, mode};
use crate::emulator::motor::{Limits, Wish};
use crate::emulator::plant::Motion;
use crate::health::OVERLOAD;
use crate::packet::Protocol;
use crate::registers::DriveMode;

impl EmulatedServo {
    /// Maximum current that the servo allows in its mode, A.
    pub fn most_current(&self) -> f64 {
        let registers = self.registers();
        let unit = self.model.current_unit;
        let (_, stall_current) = self.model.stall;
        let limit = registers.current_limit.map_or(0, |limit| self.get(limit)) as f64 * unit;
        match (self.model.protocol, self.mode()) {
            (Protocol::Dynamixel, mode::CURRENT) => limit.min(stall_current),
            (Protocol::Dynamixel, mode::CURRENT_LIMITED) => {
                let goal = registers.goal_current.map_or(0, |goal| self.get(goal));
                (goal.abs() as f64 * unit).min(limit).min(stall_current)
            }
            (Protocol::Feetech, 0) => {
                let share = registers.output_limit.map_or(1000, |limit| self.get(limit));
                stall_current * share.min(1000) as f64 / 1000.0
            }
            _ => stall_current,
        }
    }

    /// Target that the goals set for the motor with the horn at `angle`, rad, or `None` without torque.
    pub(super) fn wish(&self, angle: f64) -> Option<Wish> {
        let registers = self.registers();
        if self.get(registers.torque) == 0 {
            return None;
        }
        let (protocol, number) = (self.model.protocol, self.mode());
        let limits = registers.position_limits.map(|limit| self.get(limit));
        if protocol == Protocol::FeetechScs && limits == [0, 0] {
            // With these limits the servo is a motor without position control, which is not emulated.
            return None;
        }
        let is = |mode: DriveMode| mode.number(protocol) == number;
        if is(DriveMode::Velocity) {
            let goal = self.get(registers.goal_velocity) as f64;
            return Some(Wish::Velocity(goal * self.model.velocity_unit));
        }
        match (protocol, number, registers.goal_current) {
            (Protocol::Dynamixel, mode::CURRENT, Some(goal)) => {
                let current = self.get(goal) as f64 * self.model.current_unit;
                Some(Wish::Current(current))
            }
            (Protocol::Dynamixel, mode::WITHIN_A_TURN, _) => Some(self.to_goal(angle)),
            _ if is(DriveMode::Position) || is(DriveMode::CurrentLimitedPosition) => {
                Some(self.to_goal(angle))
            }
            // Voltage and step modes.
            _ => None,
        }
    }

    /// Motion to the goal position with the horn at `angle`, rad. A Feetech servo stays within its limits, and does not
    /// pass the position at which it wraps.
    fn to_goal(&self, angle: f64) -> Wish {
        let registers = self.registers();
        let [lower, upper] = registers.position_limits.map(|limit| self.get(limit));
        let goal = match self.get(registers.goal_position) {
            goal if self.model.protocol != Protocol::Dynamixel => goal.min(upper).max(lower),
            goal => goal,
        };
        let rest = goal as f64 - self.reported(self.model.to_counts(angle));
        let fastest = match self.get(registers.profile_velocity).abs() {
            0 => f64::INFINITY,
            units => units as f64 * self.model.velocity_unit,
        };
        Wish::Position {
            rest: self.model.to_angle(rest),
            fastest,
        }
    }

    /// Ends an overload.
    pub(super) fn restart_motor(&mut self) {
        self.motor.restart();
    }

    /// Moves the motor for `step` seconds with the horn in `motion` under `load`, N m against positive motion. Returns
    /// the steady-state velocity of the horn, rad/s.
    pub(in crate::emulator) fn drive(&mut self, step: f64, motion: Motion, load: f64) -> f64 {
        let wish = self.wish(motion.angle);
        let limits = Limits {
            current: self.most_current(),
            overload: self.get(self.registers().fault) & i64::from(OVERLOAD) != 0,
        };
        let velocity = self
            .motor
            .drive(step, wish, motion, load + self.load, limits);
        if self.motor.is_overloaded() {
            self.overload();
        }
        velocity
    }

    /// Reacts to a persistent overload. A Dynamixel switches its torque off, if its shutdown register contains this
    /// fault. A Feetech servo limits its current until torque is switched on again, an SCS servo until it gets a new
    /// goal position.
    fn overload(&mut self) {
        let registers = self.registers();
        let fault = self.get(registers.fault);
        self.put(registers.fault, fault | i64::from(OVERLOAD));
        if registers
            .shutdown
            .is_some_and(|shutdown| self.get(shutdown) & i64::from(OVERLOAD) != 0)
        {
            self.put(registers.torque, 0);
        }
    }
}
