//! Emulated motor: torque, current and overload.
//!
//! A DC motor with gears. Its torque is `k I`, with the torque constant `k` of its model, minus Coulomb and viscous
//! friction. In position mode the voltage is proportional to the distance to the goal, and the back EMF reduces the
//! torque with the velocity, to zero at the no-load velocity.

use super::plant::Motion;
use crate::registers::Model;

/// Coulomb friction of the gears, relative to the stall torque; assumed.
const FRICTION: f64 = 0.02;
/// Torque lost by viscous friction at the no-load velocity, relative to the stall torque; assumed.
const VISCOSITY: f64 = 0.3;
/// Distance to the goal position at which the motor has its full voltage, rad: the default gain of the X330 series.
const FULL_VOLTAGE: f64 = 0.43;
/// Fraction of the stall current above which the motor is overloaded, and duration of the overload until the servo
/// reacts, s; assumed.
const OVERLOAD: (f64, f64) = (0.9, 1.0);
/// Fraction of the stall current to which an overloaded Feetech servo limits its current.
const PROTECTIVE: f64 = 0.2;

/// Target that the servo's firmware sets for the motor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Wish {
    /// Velocity of the horn, rad/s.
    Velocity(f64),
    /// Distance to the goal position, rad, and maximum velocity, rad/s.
    Position { rest: f64, fastest: f64 },
    /// Current, A.
    Current(f64),
}

/// Limits of the motor.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// Maximum current, A.
    pub current: f64,
    /// `true` if the servo reports an overload.
    pub overload: bool,
}

/// State of a motor.
#[derive(Debug, Clone)]
pub(super) struct Motor {
    stall_torque: f64,
    stall_current: f64,
    /// No-load velocity, rad/s.
    fastest: f64,
    /// Present current, A.
    pub current: f64,
    /// Greatest current so far, A.
    pub greatest_current: f64,
    /// Duration of the present overload, s.
    overloaded: f64,
}

impl Motor {
    /// Creates a motor without current.
    pub fn new(model: &Model) -> Self {
        let (stall_torque, stall_current) = model.stall;
        Self {
            stall_torque,
            stall_current,
            fastest: model.velocity_limit as f64 * model.velocity_unit,
            current: 0.0,
            greatest_current: 0.0,
            overloaded: 0.0,
        }
    }

    /// Ends an overload.
    pub fn restart(&mut self) {
        self.overloaded = 0.0;
    }

    /// Returns `true` if the motor has been overloaded for too long.
    pub fn is_overloaded(&self) -> bool {
        let (_, duration) = OVERLOAD;
        self.overloaded > duration
    }

    /// Runs the motor for `step` seconds. The load is a torque against positive motion, N m. Returns the steady-state
    /// velocity of the horn, rad/s.
    pub fn drive(
        &mut self,
        step: f64,
        wish: Option<Wish>,
        motion: Motion,
        load: f64,
        limits: Limits,
    ) -> f64 {
        let most = match limits.overload {
            true => limits.current.min(PROTECTIVE * self.stall_current),
            false => limits.current,
        };
        let (velocity, torque) = match wish {
            // The gears of a motor without torque block.
            None => (0.0, 0.0),
            Some(Wish::Velocity(velocity)) => self.at_velocity(velocity, load, most),
            Some(Wish::Position { rest, fastest }) => {
                self.towards(rest, fastest, motion.velocity, load, most)
            }
            Some(Wish::Current(current)) => {
                self.with_torque(self.torque(current.clamp(-most, most)), load)
            }
        };
        self.current = (torque * self.stall_current / self.stall_torque).clamp(-most, most);
        self.greatest_current = self.greatest_current.max(self.current.abs());
        let (share, _) = OVERLOAD;
        self.overloaded = match self.current.abs() >= share * self.stall_current {
            true => self.overloaded + step,
            false => 0.0,
        };
        velocity
    }

    fn torque(&self, current: f64) -> f64 {
        current * self.stall_torque / self.stall_current
    }

    /// Velocity at which the torque of friction, `resistance` per velocity, balances the accelerating `torque`.
    fn drift(&self, torque: f64, resistance: f64) -> f64 {
        let rest = torque.abs() - FRICTION * self.stall_torque;
        let speed = (rest.max(0.0) / resistance).min(self.fastest);
        speed.copysign(torque)
    }

    /// Velocity and torque of a motor that exerts this torque against a load.
    fn with_torque(&self, torque: f64, load: f64) -> (f64, f64) {
        let viscosity = VISCOSITY * self.stall_torque / self.fastest;
        (self.drift(torque - load, viscosity), torque)
    }

    /// Velocity and torque of a motor whose firmware controls its velocity with a torque of at most `most`.
    fn at_velocity(&self, velocity: f64, load: f64, most: f64) -> (f64, f64) {
        let friction = match velocity {
            0.0 => 0.0,
            velocity => (FRICTION * self.stall_torque).copysign(velocity),
        };
        let (required, available) = (load + friction, self.torque(most));
        match required.abs() <= available {
            true => (velocity, required),
            false => self.with_torque(available.copysign(required), load),
        }
    }

    /// Velocity and torque of a motor whose voltage is proportional to the distance `rest` to its goal.
    fn towards(&self, rest: f64, fastest: f64, now: f64, load: f64, most: f64) -> (f64, f64) {
        let back_emf = self.stall_torque / self.fastest;
        let voltage = self.stall_torque * (rest / FULL_VOLTAGE).clamp(-1.0, 1.0);
        let available = self.torque(most);
        let velocity = self.drift(voltage - load, back_emf);
        if (voltage - back_emf * velocity).abs() > available {
            let (velocity, torque) = self.with_torque(available.copysign(voltage), load);
            return (velocity.clamp(-fastest, fastest), torque);
        }
        let torque = (voltage - back_emf * now).clamp(-available, available);
        (velocity.clamp(-fastest, fastest), torque)
    }
}
