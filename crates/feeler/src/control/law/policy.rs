//! A learnt policy: a network that adds to the plan where the plan asks for a reflex.
//!
//! It is trained elsewhere and read from a file; running it takes neither Python nor a library. Of what came before it
//! knows its own last action alone.

mod file;
mod network;
mod tanh;

pub use file::{FORMAT, MAX_BYTES, PolicyError};

use super::Law;
use crate::control::observation::ObservationLayout;
use crate::control::plan::Plan;
use crate::control::sense::FingerSense;
use glam::DVec3;
use network::{Network, Scratch};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Which policy.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PolicyConfig {
    /// File of the policy, relative to the experiment's.
    pub file: String,
    /// What the file holds, once it was read.
    #[serde(skip)]
    pub model: Option<Arc<PolicyModel>>,
}

/// What a policy's file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct PolicyModel {
    elements: usize,
    residual_speed: f64,
    network: Network,
}

impl PolicyModel {
    /// Reads a policy's file: safetensors, whose metadata are text.
    ///
    /// | metadata | meaning |
    /// |---|---|
    /// | `format` | [`FORMAT`] |
    /// | `activation` | `tanh` or `relu`, between two layers |
    /// | `elements` | number of elements E of the fingertips that it is for |
    /// | `residual_speed` | greatest speed that each component of the output adds to the plan's, m/s |
    /// | `description` | anything; may be left out |
    ///
    /// | tensor (F32, C order) | shape |
    /// |---|---|
    /// | `input.mean`, `input.scale` | `[N]`, N numbers of an [`ObservationLayout`] of E elements |
    /// | `layer0.weight`, `layer0.bias` | `[outputs, N]`, `[outputs]` |
    /// | `layer1.weight`, … up to seven more | `[outputs, outputs of the layer before]`; the last has 3 outputs |
    ///
    /// # Errors
    /// When anything is missing, unknown, of another shape or out of range, more than 8 layers or 1,024 outputs included.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, PolicyError> {
        file::read(bytes)
    }

    /// Number of elements of the fingertips that it is for.
    pub fn elements(&self) -> usize {
        self.elements
    }
}

/// One finger that does as a policy says.
///
/// Where the plan asks for a reflex, the finger's velocity is the plan's plus `residual_speed * tanh(outputs)`, outputs along the
/// axes of the fingertip's frame `T`; where not, it is the plan's alone.
#[derive(Debug, Clone)]
pub struct Policy {
    model: Arc<PolicyModel>,
    scratch: Scratch,
    /// The newest velocity, m/s, in W.
    last_action: DVec3,
}

impl Policy {
    /// A finger at rest.
    pub fn new(model: Arc<PolicyModel>) -> Self {
        Self {
            scratch: model.network.scratch(),
            model,
            last_action: DVec3::ZERO,
        }
    }

    /// What the network adds to the plan, m/s, in W.
    fn residual(&mut self, plan: &Plan, finger: &FingerSense<'_>) -> DVec3 {
        let elements = self.model.elements;
        let layout = ObservationLayout { elements };
        let inputs = self.scratch.inputs_mut();
        if layout
            .write(plan, finger, self.last_action, inputs)
            .is_err()
        {
            // A finger of other elements: the controller stops the hand.
            return DVec3::NAN;
        }
        let outputs = self.model.network.evaluate(&mut self.scratch);
        let outputs = outputs.map(|output| f64::from(tanh::tanh(output)));
        finger.pose.rotation * (self.model.residual_speed * DVec3::from_array(outputs))
    }
}

impl Law for Policy {
    fn velocity(&mut self, plan: &Plan, finger: &FingerSense<'_>) -> DVec3 {
        self.last_action = match plan.reflex {
            true => plan.velocity + self.residual(plan, finger),
            false => plan.velocity,
        };
        self.last_action
    }
}
