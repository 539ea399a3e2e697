//! Drives of the joints: velocity control with a first-order lag, and incremental encoders.

use feeler::check::Checker;
use feeler::hand::{JointVector, MAX_JOINTS};
use multiversion::multiversion;
use serde::{Deserialize, Serialize};

/// Drives of a finger's joints, which are identical.
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

/// Ground truth of the motion of a finger's joints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joints {
    /// Motor angles, which the encoders measure (rad).
    pub position: JointVector,
    /// Joint velocities (rad/s).
    pub velocity: JointVector,
    /// Commanded joint velocities (rad/s).
    pub command: JointVector,
    /// Link angles (rad); they differ from the motor angles by backlash.
    pub link: JointVector,
    /// Width of the dead band between motor and link (rad).
    pub backlash: JointVector,
    /// Stalled joints, which ignore their commands.
    pub stalled: [bool; MAX_JOINTS],
    /// Gain and offset of the encoders.
    pub encoders: Encoders,
}

impl Joints {
    /// Number of joints.
    pub fn count(&self) -> usize {
        self.position.len()
    }

    /// Joints at rest at `position` (rad).
    pub fn at_rest(position: JointVector) -> Self {
        Self {
            position,
            velocity: JointVector::zeros(position.len()),
            command: JointVector::zeros(position.len()),
            link: position,
            backlash: JointVector::zeros(position.len()),
            stalled: [false; MAX_JOINTS],
            encoders: Encoders::exact(position.len()),
        }
    }
}

/// Errors of a finger's encoders, which measure `gain * angle + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Encoders {
    /// Ratio of the measured to the actual rotation.
    pub gain: JointVector,
    /// Offset of the measured angle (rad).
    pub offset: JointVector,
}

impl Encoders {
    /// Encoders of `joints` joints, without errors.
    pub fn exact(joints: usize) -> Self {
        Self {
            gain: JointVector::splat(joints, 1.0),
            offset: JointVector::zeros(joints),
        }
    }

    /// Measured angles for the joint angles `position` (rad).
    pub fn show(&self, position: JointVector) -> JointVector {
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
    pub fn joints(&self, position: JointVector) -> Joints {
        Joints {
            backlash: JointVector::splat(position.len(), self.backlash),
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
    #[inline]
    pub fn advance(
        &self,
        joints: &mut Joints,
        step: f64,
        remaining: f64,
        limits: (JointVector, JointVector),
    ) {
        match joints.count() {
            // A constant, so that the loop is unrolled.
            3 => self.advance_joints(3, joints, step, remaining, &limits),
            count => self.advance_joints(count, joints, step, remaining, &limits),
        }
    }

    #[inline(always)]
    fn advance_joints(
        &self,
        count: usize,
        joints: &mut Joints,
        step: f64,
        remaining: f64,
        (lower, upper): &(JointVector, JointVector),
    ) {
        let lag = self.lag * (1.0 - remaining);
        let [positions, velocities, links] =
            [&mut joints.position, &mut joints.velocity, &mut joints.link]
                .map(|vector| &mut vector.as_mut_slice()[..count]);
        for joint in 0..count {
            let moving = |velocity: f64| match joints.stalled[joint] {
                true => 0.0,
                false => velocity,
            };
            let command = moving(joints.command[joint]);
            let error = moving(velocities[joint]) - command;
            let free = positions[joint] + step * command + lag * error;
            let position = clamp(free, lower[joint], upper[joint]);
            let stopped = free != position;
            positions[joint] = position;
            velocities[joint] = match stopped {
                true => 0.0,
                false => command + remaining * error,
            };
            let play = joints.backlash[joint] / 2.0;
            links[joint] = clamp(links[joint], position - play, position + play);
        }
    }

    /// Quantizes the joint angles `position` to encoder counts (rad).
    pub fn encode(&self, position: JointVector) -> JointVector {
        to_multiples(position, self.encoder_resolution)
    }
}

/// Limits `value` to `lower`..`upper`, as [`JointVector::clamp`].
#[inline(always)]
fn clamp(value: f64, lower: f64, upper: f64) -> f64 {
    let raised = if value > lower { value } else { lower };
    if raised < upper { raised } else { upper }
}

/// Rounds `values` to multiples of `unit`. (Without AVX, rounding calls the C library.)
#[multiversion(targets("x86_64+avx2"))]
fn to_multiples(values: JointVector, unit: f64) -> JointVector {
    values.map(|value| (value / unit).round() * unit)
}
