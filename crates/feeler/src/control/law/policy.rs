//! Learned policy: a neural network whose output is added to the planned velocity while the plan enables the slip
//! reflex.
//!
//! It is trained externally and loaded from a file; evaluation requires neither Python nor a library. Its only state is
//! its last action.

mod file;
mod network;
mod tanh;

pub use file::{FORMAT, MAX_BYTES, PolicyError};

use super::Law;
use crate::control::observation::ObservationLayout;
use crate::control::plan::Plan;
use crate::control::sense::FingerReadings;
use glam::DVec3;
use network::{Network, Scratch};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Policy file of a control law.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PolicyConfig {
    /// File of the policy, relative to the experiment file.
    pub file: String,
    /// Content of the file; `None` before it is loaded.
    #[serde(skip)]
    pub model: Option<Arc<PolicyModel>>,
}

/// Neural network of a policy file, with its metadata.
#[derive(Debug, Clone, PartialEq)]
pub struct PolicyModel {
    layout: ObservationLayout,
    residual_speed: f64,
    network: Network,
}

impl PolicyModel {
    /// Parses a policy file: safetensors with text metadata.
    ///
    /// | metadata | meaning |
    /// |---|---|
    /// | `format` | [`FORMAT`] |
    /// | `activation` | `tanh` or `relu`, between two layers |
    /// | `elements` | number of elements E of the fingertips that the policy was made for |
    /// | `joints` | number of joints of the fingers; optional, 3 if missing |
    /// | `residual_speed` | maximum speed that each component of the output adds to the plan's velocity (m/s) |
    /// | `description` | any text; optional |
    ///
    /// | tensor (F32, C order) | shape |
    /// |---|---|
    /// | `input.mean`, `input.scale` | `[N]`, N numbers of an [`ObservationLayout`] of E elements and these joints |
    /// | `layer0.weight`, `layer0.bias` | `[outputs, N]`, `[outputs]` |
    /// | `layer1.weight`, … up to seven more | `[outputs, outputs of the previous layer]`; the last has 3 outputs |
    ///
    /// # Errors
    /// If an entry or tensor is missing, unknown, of another shape or out of range, including more than 8 layers or
    /// 1,024 outputs.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, PolicyError> {
        file::read(bytes)
    }

    /// Number of elements of the fingertips that the policy was made for.
    pub fn elements(&self) -> usize {
        self.layout.elements
    }

    /// Number of joints of the fingers that the policy was made for.
    pub fn joints(&self) -> usize {
        self.layout.joints
    }
}

/// State of the law for one finger that is controlled by a policy.
///
/// While the plan enables the slip reflex, the finger's velocity is the planned one plus `residual_speed *
/// tanh(outputs)`, with the outputs along the axes of the fingertip frame `T`. Otherwise it is the planned velocity.
#[derive(Debug, Clone)]
pub struct Policy {
    model: Arc<PolicyModel>,
    scratch: Scratch,
    /// Velocity of the latest control step (m/s, in W).
    last_action: DVec3,
}

impl Policy {
    /// Creates the law for a finger at rest.
    pub fn new(model: Arc<PolicyModel>) -> Self {
        Self {
            scratch: model.network.scratch(),
            model,
            last_action: DVec3::ZERO,
        }
    }

    /// Velocity that the network adds to the planned velocity (m/s, in W).
    fn residual(&mut self, plan: &Plan, finger: &FingerReadings<'_>) -> DVec3 {
        let layout = self.model.layout;
        let inputs = self.scratch.inputs_mut();
        if layout
            .write(plan, finger, self.last_action, inputs)
            .is_err()
        {
            // The number of elements or joints differs: NaN makes the controller stop the hand.
            return DVec3::NAN;
        }
        let outputs = self.model.network.evaluate(&mut self.scratch);
        let outputs = outputs.map(|output| f64::from(tanh::tanh(output)));
        finger.pose.rotation * (self.model.residual_speed * DVec3::from_array(outputs))
    }
}

impl Law for Policy {
    fn velocity(&mut self, plan: &Plan, finger: &FingerReadings<'_>) -> DVec3 {
        self.last_action = match plan.reflex {
            true => plan.velocity + self.residual(plan, finger),
            false => plan.velocity,
        };
        self.last_action
    }
}
