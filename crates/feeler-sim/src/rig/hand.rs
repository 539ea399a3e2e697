//! The simulated rig and its hand, behind the traits of real hardware.

use crate::world::simulation::World;
use feeler::hand::{Hand, HandCommand, HandError, HandState, JointVector, check_finger_count};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Shared handle to a world, for the simulated hand and sensors.
#[derive(Clone)]
pub struct SimRig {
    world: Arc<Mutex<World>>,
}

impl SimRig {
    /// Wraps `world`.
    pub fn new(world: World) -> Self {
        Self {
            world: Arc::new(Mutex::new(world)),
        }
    }

    /// Locks the world. Ignores poisoning by a panic in another thread.
    pub fn world(&self) -> MutexGuard<'_, World> {
        self.world.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Drives and encoders of the simulated hand. Each command advances the world.
pub struct SimHand {
    rig: SimRig,
    fingers: usize,
    steps_per_command: usize,
    period: f64,
    /// Encoder readings at the last command (rad).
    encoded_before: Vec<JointVector>,
}

impl SimHand {
    /// Creates the hand of `rig`; every command advances the world by `steps_per_command` steps.
    pub fn new(rig: SimRig, steps_per_command: usize) -> Self {
        let world = rig.world();
        let fingers = world.state().fingers.len();
        let encoded_before = (0..fingers).map(|finger| world.encoded(finger)).collect();
        let period = steps_per_command as f64 * world.model().step;
        drop(world);
        Self {
            rig,
            fingers,
            steps_per_command,
            period,
            encoded_before,
        }
    }

    /// Begins a control period; joint velocities are averages since this call.
    pub fn begin_period(&mut self) {
        let world = self.rig.world();
        for (finger, before) in self.encoded_before.iter_mut().enumerate() {
            *before = world.encoded(finger);
        }
    }

    /// Applies `command` to the drives and advances the world by one step.
    ///
    /// # Errors
    /// If `command` is for another number of fingers, or a quantity of the world is no longer finite.
    pub fn advance(&mut self, command: &HandCommand) -> Result<(), HandError> {
        self.advance_by(1, command)
    }

    fn advance_by(&self, steps: usize, command: &HandCommand) -> Result<(), HandError> {
        check_finger_count(self.fingers, command.joint_velocity().len())?;
        let mut world = self.rig.world();
        for (finger, &velocity) in command.joint_velocity().iter().enumerate() {
            world.command(finger, velocity);
        }
        let advanced = world.advance(steps);
        advanced.map_err(|e| HandError::Failed(e.to_string()))
    }
}

impl Hand for SimHand {
    fn finger_count(&self) -> usize {
        self.fingers
    }

    fn read(&mut self, state: &mut HandState) -> Result<(), HandError> {
        check_finger_count(self.fingers, state.joints.len())?;
        let world = self.rig.world();
        state.stamp = world.state().time;
        let fingers = self.encoded_before.iter().enumerate();
        for (joints, (finger, &before)) in state.joints.iter_mut().zip(fingers) {
            joints.position = world.encoded(finger);
            joints.velocity = (joints.position - before) / self.period;
        }
        Ok(())
    }

    fn command(&mut self, command: &HandCommand) -> Result<(), HandError> {
        self.begin_period();
        self.advance_by(self.steps_per_command, command)
    }
}
