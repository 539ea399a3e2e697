//! Drives of the joints: velocity control with a first-order lag, and incremental encoders.

use feeler::check::Checker;
use glam::{BVec3, DVec3};
use multiversion::multiversion;
use serde::{Deserialize, Serialize};

/// Drives of a finger's three joints, which are identical.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ServoConfig {
    /// Time constant of the velocity's response to a command (s).
    pub lag: f64,
    /// Angle of one encoder count (rad).
    pub encoder_resolution: f64,
    /// Width of the dead band between a joint's motor, which the encoder measures, and its link (rad): on reversal, the
    /// motor turns by this angle before the link follows. Forces do not move the link within the band. The joint starts
    /// in the middle of the band.
    pub backlash: f64,
}

impl Default for ServoConfig {
    /// Drives of the reference experiment, without backlash.
    fn default() -> Self {
        Self {
            lag: 0.0125,
            encoder_resolution: 1e-5,
            backlash: 0.0,
        }
    }
}

/// Ground truth of the motion of a finger's three joints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joints {
    /// Motor angles, which the encoders measure (rad).
    pub position: DVec3,
    /// Joint velocities (rad/s).
    pub velocity: DVec3,
    /// Commanded joint velocities (rad/s).
    pub command: DVec3,
    /// Link angles (rad); they differ from the motor angles by backlash.
    pub link: DVec3,
    /// Width of the dead band between motor and link (rad).
    pub backlash: DVec3,
    /// Stalled joints, which ignore their commands.
    pub stalled: BVec3,
    /// Gain and offset of the encoders.
    pub encoders: Encoders,
}

impl Joints {
    /// Joints at rest at `position` (rad).
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

/// Errors of a finger's encoders, which measure `gain * angle + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Encoders {
    /// Ratio of the measured to the actual rotation.
    pub gain: DVec3,
    /// Offset of the measured angle (rad).
    pub offset: DVec3,
}

impl Default for Encoders {
    /// Encoders without errors.
    fn default() -> Self {
        Self {
            gain: DVec3::ONE,
            offset: DVec3::ZERO,
        }
    }
}

impl Encoders {
    /// Measured angles for the joint angles `position` (rad).
    pub fn show(&self, position: DVec3) -> DVec3 {
        self.gain * position + self.offset
    }
}

impl ServoConfig {
    /// Checks that every value of the table `key` is in its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        checker.not_negative(&format!("{key}.lag"), self.lag);
        let resolution = self.encoder_resolution;
        checker.positive(&format!("{key}.encoder_resolution"), resolution);
        checker.between(&format!("{key}.backlash"), self.backlash, 0.0, 1.0);
    }

    /// Joints of these drives at rest at `position` (rad), in the middle of their backlash.
    pub fn joints(&self, position: DVec3) -> Joints {
        Joints {
            backlash: DVec3::splat(self.backlash),
            ..Joints::at_rest(position)
        }
    }

    /// Fraction of a velocity error that remains after `step` seconds.
    pub fn remaining_error(&self, step: f64) -> f64 {
        if self.lag > 0.0 {
            libm::exp(-step / self.lag)
        } else {
            0.0
        }
    }

    /// Moves `joints` over `step` seconds; exact for a constant command. `remaining` is [`Self::remaining_error`] of
    /// that step. Joints stop instantly at the limits `lower` and `upper` (rad).
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

    /// Quantizes the joint angles `position` to encoder counts (rad).
    pub fn encode(&self, position: DVec3) -> DVec3 {
        to_multiples(position, self.encoder_resolution)
    }
}

/// Rounds `values` to multiples of `unit`. (Without AVX, rounding calls the C library.)
#[multiversion(targets("x86_64+avx2"))]
fn to_multiples(values: DVec3, unit: f64) -> DVec3 {
    (values / unit).round() * unit
}
