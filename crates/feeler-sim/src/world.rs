//! The simulated world: a model and its state.

use super::config::SimConfig;
use super::error::SimError;
use super::free_bodies::FreeBodies;
use super::model::WorldModel;
use super::pose::Pose;
use super::random::{Generator, Purpose, generator};
use super::rig_faults::RigFaults;
use super::state::State;
use super::step::{step, wrench};
use super::torque_sensor::TorqueReading;
use feeler::hand::finger::FingerGeometry;
use feeler::sensor::layout::ElementLayout;
use glam::DVec3;
use std::path::Path;

/// A rig that is being simulated.
pub struct World {
    model: WorldModel,
    state: State,
    bodies: Option<Box<FreeBodies>>,
    faults: RigFaults,
    torque_noise: Generator,
}

impl World {
    /// The world of `config` at time 0: `fingers` with the fingertips that they carry, at rest at
    /// `joints` (rad, one triple per finger). Files that `config` names are relative to `folder`.
    ///
    /// # Errors
    /// When a part of it cannot be made, or parts of it are inside each other.
    pub fn new(
        config: &SimConfig,
        fingers: &[(FingerGeometry, ElementLayout)],
        joints: &[DVec3],
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
            state,
            model,
        })
    }

    /// Advances by one time step.
    ///
    /// # Errors
    /// When a quantity is not finite any more. The world is of no use from there on.
    pub fn step(&mut self) -> Result<(), SimError> {
        self.advance(1)
    }

    /// Advances by so many time `steps` as that many times [`step`](Self::step) does, to the bit, but spares itself what only who looks
    /// in between would see. Whether all is finite is looked at after the last one.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn advance(&mut self, steps: usize) -> Result<(), SimError> {
        for left in (0..steps).rev() {
            self.faults.apply(&mut self.state);
            let bodies = self.bodies.as_deref_mut();
            step(&self.model, &mut self.state, bodies, left == 0);
        }
        // What is not finite stays so.
        self.state.check_finite(&self.model)
    }

    /// What never changes.
    pub fn model(&self) -> &WorldModel {
        &self.model
    }

    /// What does.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// The object whose surface is nearest to `point` (m, in W), and its distance, m; negative inside it. None where
    /// there is no object.
    pub fn nearest_object(&self, point: DVec3) -> Option<(&str, f64)> {
        let objects = self.model.objects.iter().zip(&self.state.objects);
        let distances = objects.map(|(object, now)| {
            let to_object = now.pose.rotation.transpose();
            let seen = to_object * (point - now.pose.position);
            // On the surface to within rounding there is no nearest point.
            let distance = object.nearest(seen).map_or(0.0, |surface| surface.distance);
            (object.name.as_str(), distance)
        });
        distances.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// What the encoders of `finger` read, rad.
    pub fn encoded(&self, finger: usize) -> DVec3 {
        let (own, state) = (&self.model.fingers[finger], &self.state.fingers[finger]);
        let joints = &state.joints;
        let shown = joints.encoders.show(joints.position) + own.encoder_offset;
        self.model.servo.encode(shown)
    }

    /// Sets the velocities that the drives of `finger` are to follow, rad/s.
    pub fn command(&mut self, finger: usize, joint_velocity: DVec3) {
        if let Some(finger) = self.state.fingers.get_mut(finger) {
            finger.joints.command = joint_velocity;
        }
    }

    /// Holds the fingertip of `finger` at `pose` (centre of the dome and fingertip frame, in W) from
    /// the next step on, whatever its joints do; with `None` it follows them again.
    pub fn hold_fingertip(&mut self, finger: usize, pose: Option<Pose>) {
        if let Some(finger) = self.state.fingers.get_mut(finger) {
            finger.held_at = pose;
            finger.watch.unseen = f64::INFINITY;
        }
    }

    /// Puts a force (N) that acts at `point` (m), both in W, on a free object, in place of the one
    /// before; it keeps acting.
    pub fn push(&mut self, object: usize, force: DVec3, point: DVec3) {
        if let Some(object) = self.state.objects.get_mut(object) {
            object.outside = (force, (point - object.pose.position).cross(force));
        }
    }

    /// Reads the torque sensor, with its noise.
    pub fn read_torque(&mut self) -> TorqueReading {
        self.model
            .torque_sensor
            .read(self.state.filtered_torque, &mut self.torque_noise)
    }

    /// Force, N, and torque about its origin, N·m, on an object by the feelers, in W.
    pub fn wrench(&self, object: usize) -> (DVec3, DVec3) {
        wrench(&self.model, &self.state, object)
    }

    /// How hard each feeler of `finger` that touches is pressed, in truth: F_z, N, in no particular order.
    pub fn compressions(&self, finger: usize) -> impl Iterator<Item = f64> + use<'_> {
        let fingers = self.model.fingers.iter().zip(&self.state.fingers);
        fingers.skip(finger).take(1).flat_map(|(finger, state)| {
            let pressed = |element: usize| {
                state.forces[element].dot(state.tip.rotation * finger.normals[element])
            };
            state.contacts.elements().map(pressed)
        })
    }

    /// The true tri-axial forces on the elements of `finger`, N, each in its own frame `E_i` with
    /// the sign of a [`TactileFrame`](feeler::sensor::reading::TactileFrame).
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
            // On the feeler by the object: the reverse. Compression is that force along -z.
            let rotation = &finger.element_rotations[element];
            let on_feeler = -(rotation.transpose() * (to_fingertip * state.forces[element]));
            *force = on_feeler.with_z(-on_feeler.z);
        });
    }
}
