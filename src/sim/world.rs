//! The simulated world: a model and its state.

use super::model::Model;
use super::random::{Generator, Purpose, generator};
use super::state::State;
use super::step::step;
use super::torque_sensor::TorqueReading;
use glam::{DMat3, DVec3};

/// A rig that is being simulated.
pub struct World {
    model: Model,
    state: State,
    element_rotations: Vec<DMat3>,
    torque_noise: Generator,
}

impl World {
    /// The world at time 0, fingers at rest at `joints` (rad, one triple per finger).
    pub fn new(model: Model, joints: &[DVec3], seed: u64) -> Self {
        let state = State::new(&model, joints);
        Self {
            element_rotations: model.layout.elements.iter().map(|e| e.rotation).collect(),
            torque_noise: generator(seed, Purpose::TorqueNoise),
            state,
            model,
        }
    }

    /// Advances by one time step.
    pub fn step(&mut self) {
        step(&self.model, &mut self.state);
    }

    /// What never changes.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// What does.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Sets the velocities that the drives of `finger` are to follow, rad/s.
    pub fn command(&mut self, finger: usize, joint_velocity: DVec3) {
        if let Some(finger) = self.state.fingers.get_mut(finger) {
            finger.joints.command = joint_velocity;
        }
    }

    /// Reads the torque sensor, with its noise.
    pub fn read_torque(&mut self) -> TorqueReading {
        self.model
            .torque_sensor
            .read(self.state.filtered_torque, &mut self.torque_noise)
    }

    /// The true tri-axial forces on the elements of `finger`, N, each in its own frame `E_i` with
    /// the sign of a [`TactileFrame`](crate::sensor::reading::TactileFrame).
    pub fn element_forces(&self, finger: usize, forces: &mut [DVec3]) {
        let Some(finger) = self.state.fingers.get(finger) else {
            return;
        };
        let to_fingertip = finger.rotation.transpose();
        let elements = self.element_rotations.iter().zip(&finger.forces);
        for (force, (rotation, &on_object)) in forces.iter_mut().zip(elements) {
            // On the feeler by the object: the reverse. Compression is that force along -z.
            let on_feeler = -(rotation.transpose() * (to_fingertip * on_object));
            *force = on_feeler.with_z(-on_feeler.z);
        }
    }
}
