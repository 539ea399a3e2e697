//! The simulated world: a model and its state.

use super::config::SimConfig;
use super::model::WorldModel;
use super::state::State;
use super::step::{step, wrench};
use crate::error::SimError;
use crate::objects::free_bodies::FreeBodies;
use crate::objects::pose::Pose;
use crate::random::{Generator, Purpose, generator};
use crate::rig::rig_faults::RigFaults;
use crate::rig::torque_sensor::TorqueReading;
use feeler::hand::{FingerGeometry, JointVector};
use feeler::sensor::fingertip::ElementLayout;
use glam::DVec3;
use std::path::Path;

/// A simulated rig.
pub struct World {
    model: WorldModel,
    state: State,
    bodies: Option<Box<FreeBodies>>,
    faults: RigFaults,
    torque_noise: Generator,
    /// Called after every step.
    observer: Option<Observer>,
}

/// Function that is called with the model and the state after every step.
type Observer = Box<dyn FnMut(&WorldModel, &State) + Send>;

impl World {
    /// Creates the world of `config` at time 0, with `fingers` at rest at the joint angles `joints` (rad, one vector
    /// per finger). Paths in `config` are relative to `folder`.
    ///
    /// # Errors
    /// If an object or an override is invalid, or if bodies overlap.
    pub fn new(
        config: &SimConfig,
        fingers: &[(FingerGeometry, ElementLayout)],
        joints: &[JointVector],
        folder: &Path,
        seed: u64,
    ) -> Result<Self, SimError> {
        let model = WorldModel::new(config, fingers, folder, seed)?;
        let state = State::new(&model, joints);
        super::start::check(&model, &state)?;
        Ok(Self {
            bodies: FreeBodies::new(&model),
            faults: RigFaults::new(&config.fault, &model),
            torque_noise: generator(seed, Purpose::TorqueNoise),
            observer: None,
            state,
            model,
        })
    }

    /// Advances by one time step.
    ///
    /// # Errors
    /// If a quantity is no longer finite. The world is unusable afterwards.
    pub fn step(&mut self) -> Result<(), SimError> {
        self.advance(1)
    }

    /// Advances by `steps` time steps. The result is bit-identical to that many calls of [`step`](Self::step), but
    /// intermediate states are only computed as far as later ones depend on them. Checks for finite values after the
    /// last step.
    ///
    /// # Errors
    /// Same as [`step`](Self::step).
    pub fn advance(&mut self, steps: usize) -> Result<(), SimError> {
        for left in (0..steps).rev() {
            self.faults.apply(&mut self.state);
            let bodies = self.bodies.as_deref_mut();
            let is_seen = left == 0 || self.observer.is_some();
            step(&self.model, &mut self.state, bodies, is_seen);
            if let Some(observer) = &mut self.observer {
                observer(&self.model, &self.state);
            }
        }
        // Non-finite values persist.
        self.state.check_finite(&self.model)
    }

    /// Calls `observer` with the ground truth after every step, also within [`advance`](Self::advance). Replaces an
    /// earlier observer.
    pub fn observe(&mut self, observer: impl FnMut(&WorldModel, &State) + Send + 'static) {
        self.observer = Some(Box::new(observer));
    }

    /// Constant part of the world.
    pub fn model(&self) -> &WorldModel {
        &self.model
    }

    /// Current state.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Object whose surface is nearest to `point` (in W, m), and its distance (m), negative inside the object. `None`
    /// if the world has no objects.
    pub fn nearest_object(&self, point: DVec3) -> Option<(&str, f64)> {
        let objects = self.model.objects.iter().zip(&self.state.objects);
        let distances = objects.map(|(object, now)| {
            let to_object = now.pose.rotation.transpose();
            let seen = to_object * (point - now.pose.position);
            // At distance 0, up to rounding, the nearest point is undefined.
            let distance = object.nearest(seen).map_or(0.0, |surface| surface.distance);
            (object.name.as_str(), distance)
        });
        distances.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Encoder readings of `finger` (rad).
    pub fn encoded(&self, finger: usize) -> JointVector {
        let (own, state) = (&self.model.fingers[finger], &self.state.fingers[finger]);
        let joints = &state.joints;
        let shown = joints.encoders.show(joints.position) + own.encoder_offset;
        self.model.servo.encode(shown)
    }

    /// Multiplies the friction coefficients of feelers on all objects by `factor` from the next step on. On objects with
    /// a friction fault, the fault's factor applies instead.
    pub fn set_friction_factor(&mut self, factor: f64) {
        for object in &mut self.state.objects {
            object.friction_factor = factor;
        }
    }

    /// Sets the target joint velocities of the drives of `finger` (rad/s).
    pub fn command(&mut self, finger: usize, joint_velocity: JointVector) {
        if let Some(finger) = self.state.fingers.get_mut(finger) {
            finger.joints.command = joint_velocity;
        }
    }

    /// Holds the fingertip of `finger` at `pose` (dome's centre and fingertip frame, in W) from the next step on,
    /// independent of its joints. With `None` it follows the joints again.
    pub fn hold_fingertip(&mut self, finger: usize, pose: Option<Pose>) {
        if let Some(finger) = self.state.fingers.get_mut(finger) {
            finger.held_at = pose;
            finger.watch.unseen = f64::INFINITY;
        }
    }

    /// Applies a constant force (N) to a free object at `point` (m), both in W. Replaces the previous force.
    pub fn push(&mut self, object: usize, force: DVec3, point: DVec3) {
        if let Some(object) = self.state.objects.get_mut(object) {
            object.outside = (force, (point - object.pose.position).cross(force));
        }
    }

    /// Reads the torque sensor, including noise.
    pub fn read_torque(&mut self) -> TorqueReading {
        self.model
            .torque_sensor
            .read(self.state.filtered_torque, &mut self.torque_noise)
    }

    /// Force (N) of the feelers on an object, and torque (N·m) about its origin, in W.
    pub fn wrench(&self, object: usize) -> (DVec3, DVec3) {
        wrench(&self.model, &self.state, object)
    }

    /// Total force of the feelers of `finger` on objects, in W (N).
    pub fn contact_force(&self, finger: usize) -> DVec3 {
        let state = self.state.fingers.get(finger);
        state.map_or(DVec3::ZERO, |state| {
            let touching = state.contacts.elements();
            touching.map(|element| state.forces[element]).sum()
        })
    }

    /// True compressions `F_z` of the feelers of `finger` that are in contact (N), in no particular order.
    pub fn compressions(&self, finger: usize) -> impl Iterator<Item = f64> + use<'_> {
        let fingers = self.model.fingers.iter().zip(&self.state.fingers);
        fingers.skip(finger).take(1).flat_map(|(finger, state)| {
            let pressed = |element: usize| {
                state.forces[element].dot(state.tip.rotation * finger.normals[element])
            };
            state.contacts.elements().map(pressed)
        })
    }

    /// Writes the true tri-axial forces on the elements of `finger` (N), each in its frame `E_i`, with the signs of a
    /// [`TactileFrame`](feeler::sensor::forces::TactileFrame).
    pub fn element_forces(&self, finger: usize, forces: &mut [DVec3]) {
        let (Some(state), Some(finger)) = (
            self.state.fingers.get(finger),
            self.model.fingers.get(finger),
        ) else {
            return;
        };
        let to_fingertip = state.tip.rotation.transpose();
        forces.fill(DVec3::ZERO);
        state.contacts.elements().for_each(|element| {
            let Some(force) = forces.get_mut(element) else {
                return;
            };
            // `state.forces` act on the object; the force on the feeler is opposite. F_z is compression, along -z.
            let rotation = &finger.element_rotations[element];
            let on_feeler = -(rotation.transpose() * (to_fingertip * state.forces[element]));
            *force = on_feeler.with_z(-on_feeler.z);
        });
    }
}
