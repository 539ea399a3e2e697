//! The joints' drives: velocity controlled, with a first-order lag and an incremental encoder.

use feeler::check::Checker;
use glam::{BVec3, DVec3};
use multiversion::multiversion;
use serde::{Deserialize, Serialize};

/// The drives of a finger's three joints; all alike.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ServoConfig {
    /// Time constant with which a joint's velocity follows its command, s.
    pub lag: f64,
    /// Angle of one encoder count, rad.
    pub encoder_resolution: f64,
    /// Width of the dead band between a joint's motor, which the encoder reads, and its link, rad: how far
    /// the motor turns back before the link follows. Forces do not move the link within the band, and it
    /// begins in the middle.
    pub backlash: f64,
}

impl Default for ServoConfig {
    /// The reference experiment's drives, without play.
    fn default() -> Self {
        Self {
            lag: 0.0125,
            encoder_resolution: 1e-5,
            backlash: 0.0,
        }
    }
}

impl ServoConfig {
    /// Requires every value of the table `key` to be in its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        checker.not_negative(&format!("{key}.lag"), self.lag);
        let resolution = self.encoder_resolution;
        checker.positive(&format!("{key}.encoder_resolution"), resolution);
        checker.between(&format!("{key}.backlash"), self.backlash, 0.0, 1.0);
    }
}

/// The true motion of a finger's three joints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joints {
    /// Joint angles as the motors have them and the encoders read them, rad.
    pub position: DVec3,
    /// Joint velocities, rad/s.
    pub velocity: DVec3,
    /// Commanded joint velocities, rad/s.
    pub command: DVec3,
    /// Joint angles as the links have them, rad: those of the motors but for backlash.
    pub link: DVec3,
    /// Width of the dead band between motor and link, rad.
    pub backlash: DVec3,
    /// Joints that ignore their commands and stand still.
    pub stalled: BVec3,
    /// What the encoders make of the joint angles.
    pub encoders: Encoders,
}

impl Joints {
    /// Joints at rest at `position`, rad.
    pub fn at_rest(position: DVec3) -> Self {
        Self {
            position,
            velocity: DVec3::ZERO,
            command: DVec3::ZERO,
            link: position,
            backlash: DVec3::ZERO,
            stalled: BVec3::FALSE,
            encoders: Encoders::default(),
        }
    }
}

/// How a finger's encoders show its joint angles: `gain * angle + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Encoders {
    /// What they show of a turn.
    pub gain: DVec3,
    /// What they show too much, rad.
    pub offset: DVec3,
}

impl Default for Encoders {
    /// They show what is.
    fn default() -> Self {
        Self {
            gain: DVec3::ONE,
            offset: DVec3::ZERO,
        }
    }
}

impl Encoders {
    /// What they show where the joints are at `position`, rad.
    pub fn show(&self, position: DVec3) -> DVec3 {
        self.gain * position + self.offset
    }
}

impl ServoConfig {
    /// Joints with these drives, at rest at `position`, rad, in the middle of their backlash.
    pub fn joints(&self, position: DVec3) -> Joints {
        Joints {
            backlash: DVec3::splat(self.backlash),
            ..Joints::at_rest(position)
        }
    }

    /// The part of a velocity error that is left after `step` seconds.
    pub fn remaining_error(&self, step: f64) -> f64 {
        if self.lag > 0.0 {
            (-step / self.lag).exp()
        } else {
            0.0
        }
    }

    /// Moves `joints` over `step` seconds, exactly for a constant command; `remaining` is
    /// [`Self::remaining_error`] of that step. The joints stop dead at `lower` and `upper`, rad.
    pub fn advance(
        &self,
        joints: &mut Joints,
        step: f64,
        remaining: f64,
        (lower, upper): (DVec3, DVec3),
    ) {
        let command = DVec3::select(joints.stalled, DVec3::ZERO, joints.command);
        let velocity = DVec3::select(joints.stalled, DVec3::ZERO, joints.velocity);
        let error = velocity - command;
        let free = joints.position + step * command + self.lag * (1.0 - remaining) * error;
        joints.velocity = command + remaining * error;
        joints.position = free.clamp(lower, upper);
        let stopped = free.cmpne(joints.position);
        joints.velocity = DVec3::select(stopped, DVec3::ZERO, joints.velocity);
        let play = joints.backlash / 2.0;
        joints.link = joints
            .link
            .clamp(joints.position - play, joints.position + play);
    }

    /// What the encoders count at the joint angles `position`, as an angle, rad.
    pub fn encode(&self, position: DVec3) -> DVec3 {
        to_multiples(position, self.encoder_resolution)
    }
}

/// The multiples of `unit` that are nearest to `values`. (Without AVX, rounding is a call of the system's library.)
#[multiversion(targets("x86_64+avx2"))]
fn to_multiples(values: DVec3, unit: f64) -> DVec3 {
    (values / unit).round() * unit
}
