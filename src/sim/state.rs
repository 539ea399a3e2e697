//! What changes in a run.

use super::cap::{CapPose, CapState};
use super::feeler::Anchor;
use super::model::Model;
use super::servo::Joints;
use crate::hand::kinematics::fingertip_pose;
use glam::{DMat3, DVec3};

/// The true state of the simulated world.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Simulated time, s.
    pub time: f64,
    /// Steps taken; time is `steps * step`, so that it does not drift.
    pub steps: u64,
    /// The fingers.
    pub fingers: Vec<FingerState>,
    /// The cap.
    pub cap: CapState,
    /// Where the cap is.
    pub cap_pose: CapPose,
    /// Torque behind the sensor's low-pass, N·m.
    pub filtered_torque: f64,
}

/// The true state of one finger.
#[derive(Debug, Clone, PartialEq)]
pub struct FingerState {
    /// Its joints.
    pub joints: Joints,
    /// Centre of its dome in W, m.
    pub position: DVec3,
    /// Rotation from the fingertip frame `T` to W.
    pub rotation: DMat3,
    /// What each feeler holds on to.
    pub anchors: Vec<Option<Anchor>>,
    /// Force on the object by each feeler, N, in W.
    pub forces: Vec<DVec3>,
}

impl State {
    /// The world at time 0: fingers at rest at `joints` (rad, one triple per finger), cap open.
    pub fn new(model: &Model, joints: &[DVec3]) -> Self {
        let elements = model.normals.len();
        let fingers = model
            .fingers
            .iter()
            .zip(joints)
            .map(|(geometry, &theta)| {
                let (position, rotation) = fingertip_pose(geometry, theta);
                FingerState {
                    joints: Joints::at_rest(theta),
                    position,
                    rotation,
                    anchors: vec![None; elements],
                    forces: vec![DVec3::ZERO; elements],
                }
            })
            .collect();
        let cap = CapState::default();
        Self {
            time: 0.0,
            steps: 0,
            fingers,
            cap,
            cap_pose: model.cap.pose(&cap, model.cap_start_angle),
            filtered_torque: 0.0,
        }
    }
}
