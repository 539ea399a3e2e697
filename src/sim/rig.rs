//! The simulated rig behind the seams: its hand, and fingertips whose forces are sensed directly.

use super::random::{Generator, Purpose, generator, normal};
use super::world::World;
use crate::hand::hand::{Hand, HandCommand, HandError, HandState};
use crate::sensor::reading::{SensorError, TactileFrame, TactileSensor};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A handle to a world that the simulated hand and sensors share.
#[derive(Clone)]
pub struct Rig {
    world: Arc<Mutex<World>>,
}

impl Rig {
    /// Shares `world`.
    pub fn new(world: World) -> Self {
        Self {
            world: Arc::new(Mutex::new(world)),
        }
    }

    /// The world, for as long as the guard lives. A panic elsewhere does not lock it for good.
    pub fn world(&self) -> MutexGuard<'_, World> {
        self.world.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The drives and encoders of the simulated hand. Commanding it advances the world.
pub struct SimHand {
    rig: Rig,
    fingers: usize,
    steps_per_command: usize,
    period: f64,
    /// Encoder readings at the last command, rad.
    encoded_before: Vec<DVec3>,
}

impl SimHand {
    /// The hand of `rig`; every command advances the world by `steps_per_command` steps.
    pub fn new(rig: Rig, steps_per_command: usize) -> Self {
        let world = rig.world();
        let servo = &world.model().servo;
        let fingers = &world.state().fingers;
        let encoded_before = fingers
            .iter()
            .map(|f| servo.encode(f.joints.position))
            .collect();
        let (fingers, period) = (fingers.len(), steps_per_command as f64 * world.model().step);
        drop(world);
        Self {
            rig,
            fingers,
            steps_per_command,
            period,
            encoded_before,
        }
    }

    fn check_fingers(&self, actual: usize) -> Result<(), HandError> {
        let expected = self.fingers;
        if actual == expected {
            Ok(())
        } else {
            Err(HandError::FingerCount { expected, actual })
        }
    }
}

impl Hand for SimHand {
    fn finger_count(&self) -> usize {
        self.fingers
    }

    fn read(&mut self, state: &mut HandState) -> Result<(), HandError> {
        self.check_fingers(state.joints.len())?;
        let world = self.rig.world();
        state.stamp = world.state().time;
        let fingers = world.state().fingers.iter().zip(&self.encoded_before);
        for (joints, (finger, &before)) in state.joints.iter_mut().zip(fingers) {
            joints.position = world.model().servo.encode(finger.joints.position);
            joints.velocity = (joints.position - before) / self.period;
        }
        Ok(())
    }

    fn command(&mut self, command: &HandCommand) -> Result<(), HandError> {
        self.check_fingers(command.joint_velocity.len())?;
        let mut world = self.rig.world();
        for (finger, &velocity) in command.joint_velocity.iter().enumerate() {
            let position = world.state().fingers[finger].joints.position;
            self.encoded_before[finger] = world.model().servo.encode(position);
            world.command(finger, velocity);
        }
        for _ in 0..self.steps_per_command {
            world.step();
        }
        Ok(())
    }
}

/// Noise of forces that are sensed without pictures.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DirectSensingConfig {
    /// Standard deviation of an element's normal force, N.
    pub normal_noise: f64,
    /// Standard deviation of either component of an element's shear force, N.
    pub shear_noise: f64,
}

/// A fingertip whose true forces are read, with noise, and no picture is made: for speed.
pub struct DirectSensor {
    rig: Rig,
    finger: usize,
    elements: usize,
    config: DirectSensingConfig,
    random: Generator,
    sequence: u64,
}

impl DirectSensor {
    /// The fingertip of `finger`, its noise drawn from `seed`.
    pub fn new(rig: Rig, finger: usize, config: DirectSensingConfig, seed: u64) -> Self {
        let elements = rig.world().model().normals.len();
        Self {
            rig,
            finger,
            elements,
            config,
            random: generator(seed, Purpose::SensorNoise(finger)),
            sequence: 0,
        }
    }
}

impl TactileSensor for DirectSensor {
    fn element_count(&self) -> usize {
        self.elements
    }

    fn read(&mut self, reading: &mut TactileFrame) -> Result<(), SensorError> {
        let (expected, actual) = (self.elements, reading.forces.len());
        if actual != expected {
            return Err(SensorError::ElementCount { expected, actual });
        }
        let world = self.rig.world();
        world.element_forces(self.finger, &mut reading.forces);
        for force in &mut reading.forces {
            force.x += normal(&mut self.random, self.config.shear_noise);
            force.y += normal(&mut self.random, self.config.shear_noise);
            force.z += normal(&mut self.random, self.config.normal_noise);
        }
        reading.stamp = world.state().time;
        reading.sequence = self.sequence;
        self.sequence += 1;
        Ok(())
    }
}
