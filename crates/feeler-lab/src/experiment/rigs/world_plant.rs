//! The simulated world as the mechanism that emulated servos move.

use feeler::hand::{JointVector, jacobian};
use feeler_drives::config::{DrivesConfig, JointDriveConfig};
use feeler_drives::emulator::{Motion, Plant};
use feeler_sim::rig::SimRig;
use feeler_sim::world::World;

/// Fraction of a step by which the world may step early, because timestamps are not exact multiples of the step.
const STEP_TOLERANCE: f64 = 1e-6;

/// Plant that emulated servos move: the fingers of a simulated world. A servo that moves several joints couples them
/// rigidly.
pub(super) struct WorldPlant {
    rig: SimRig,
    /// Joints of each finger, and the index of the servo that moves each.
    fingers: Vec<Vec<(usize, JointDriveConfig)>>,
    motions: Vec<Motion>,
    /// Torque of the contact forces on each servo's horn, against positive motion, N m.
    loads: Vec<f64>,
    /// Goal velocity of each servo's horn, rad/s.
    goals: Vec<f64>,
    /// `true` for each servo that moves several joints.
    is_coupled: Vec<bool>,
    /// `true` if the simulation failed and is stopped.
    failed: bool,
}

impl WorldPlant {
    /// Creates the plant that the servos of `config` move.
    pub fn new(rig: SimRig, config: &DrivesConfig) -> Self {
        let ids: Vec<_> = config.servos().map(|servo| servo.id).collect();
        let servo = |joint: &JointDriveConfig| {
            let index = ids.iter().position(|&id| id == joint.id)?;
            Some((index, joint.clone()))
        };
        let is_coupled = |id| config.joints().any(|joint| joint.shared && joint.id == id);
        let fingers = config.finger.iter();
        let mut plant = Self {
            rig: rig.clone(),
            fingers: fingers
                .map(|finger| finger.joint.iter().filter_map(servo).collect())
                .collect(),
            motions: vec![Motion::default(); ids.len()],
            loads: vec![0.0; ids.len()],
            goals: vec![0.0; ids.len()],
            is_coupled: ids.iter().map(|&id| is_coupled(id)).collect(),
            failed: false,
        };
        plant.measure(&rig.world());
        plant
    }

    fn measure(&mut self, world: &World) {
        let states = world.state().fingers.iter();
        for (finger, (drives, state)) in self.fingers.iter().zip(states).enumerate() {
            let (angles, velocities) = (world.encoded(finger), state.joints.velocity);
            // The moment of the forces about the dome's centre is neglected.
            let force = world.contact_force(finger);
            let geometry = &world.model().fingers[finger].geometry;
            let columns = jacobian(geometry, state.joints.position);
            let joints = angles.iter().zip(velocities.iter()).zip(drives);
            for (((angle, velocity), (servo, joint)), column) in joints.zip(columns.columns()) {
                // The object's reaction against the force that the finger exerts on it.
                let load = f64::from(joint.direction) * column.dot(force) / joint.transmission();
                if joint.shared {
                    self.loads[*servo] += load;
                    continue;
                }
                self.loads[*servo] = load;
                self.motions[*servo] = Motion {
                    angle: joint.horn(angle),
                    velocity: joint.servo_velocity(velocity),
                };
            }
        }
    }

    /// Stops each servo of several joints if one of these cannot move further: it is at its limit or stalled.
    fn block(&mut self, world: &World) {
        let states = world.state().fingers.iter().zip(&world.model().fingers);
        for (drives, (state, model)) in self.fingers.iter().zip(states) {
            let (state, geometry) = (&state.joints, &model.geometry);
            for (joint, (servo, drive)) in drives.iter().enumerate() {
                if !self.is_coupled[*servo] {
                    continue;
                }
                let velocity = drive.joint_velocity(self.goals[*servo]);
                let position = state.position[joint];
                let is_blocked = state.stalled[joint]
                    || (velocity < 0.0 && position <= geometry.joint_lower()[joint])
                    || (velocity > 0.0 && position >= geometry.joint_upper()[joint]);
                if is_blocked {
                    self.goals[*servo] = 0.0;
                }
            }
        }
    }
}

impl Plant for WorldPlant {
    fn advance(&mut self, now: f64, goals: &[f64]) {
        let rig = self.rig.clone();
        let mut world = rig.world();
        let step = world.model().step;
        if self.failed || world.state().time + step * (1.0 - STEP_TOLERANCE) > now {
            return;
        }
        for (own, goal) in self.goals.iter_mut().zip(goals) {
            *own = *goal;
        }
        self.block(&world);
        for (finger, drives) in self.fingers.iter().enumerate() {
            let mut joints = drives.iter();
            let velocity = JointVector::zeros(drives.len());
            let velocity = velocity.map(|_| match joints.next() {
                Some((servo, joint)) => joint.joint_velocity(self.goals[*servo]),
                None => 0.0,
            });
            world.command(finger, velocity);
        }
        while world.state().time + step * (1.0 - STEP_TOLERANCE) <= now {
            if world.step().is_err() {
                // The world stops here, which the monitors of the hand detect.
                self.failed = true;
                break;
            }
        }
        self.measure(&world);
    }

    fn motion(&self, servo: usize) -> Motion {
        self.motions.get(servo).copied().unwrap_or_default()
    }

    fn load(&self, servo: usize) -> f64 {
        self.loads.get(servo).copied().unwrap_or_default()
    }
}
