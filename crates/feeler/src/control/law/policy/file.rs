//! Reads policy files (safetensors) and validates their entire content.

use super::PolicyModel;
use super::network::{Activation, LARGEST, Layer, Network};
use crate::control::observation::ObservationLayout;
use crate::hand::MAX_JOINTS;
use crate::sensor::fingertip::layout::MAX_ELEMENTS;
use safetensors::SafeTensors;
use safetensors::tensor::{Dtype, Metadata, SafeTensorError};

/// Value of `format` in the metadata.
pub const FORMAT: &str = "feeler-policy-1";
/// Maximum file size (bytes), larger than that of the largest valid network.
pub const MAX_BYTES: usize = 40 << 20;
/// Maximum number of layers.
const MAX_LAYERS: usize = 8;
/// Maximum number of outputs of a layer.
const MAX_WIDTH: usize = 1024;
/// Number of joints of a finger if the metadata has no entry `joints`.
const USUAL_JOINTS: usize = 3;
/// Number of network outputs: the components of a velocity.
const OUTPUTS: usize = 3;
/// Minimum value of the scale of an input.
const SMALLEST_SCALE: f32 = 1e-6;
/// Maximum speed that a network may add to the planned velocity (m/s).
const MAX_RESIDUAL_SPEED: f64 = 1.0;
/// Valid keys of the metadata.
const KEYS: [&str; 6] = [
    "format",
    "activation",
    "elements",
    "joints",
    "residual_speed",
    "description",
];

/// Error returned for an invalid policy file.
#[derive(Debug, thiserror::Error)]
pub enum PolicyError {
    /// The file is too long.
    #[error("expected a policy of at most {MAX_BYTES} bytes, got {actual}")]
    TooLong {
        /// Length of the file (bytes).
        actual: usize,
    },
    /// The file is damaged or not in safetensors format.
    #[error("expected a complete file in safetensors format: {source}")]
    Container {
        /// Error of the parser.
        source: SafeTensorError,
    },
    /// An entry of the metadata is missing, unknown or invalid.
    #[error("metadata {key}: expected {expected}, got {actual}")]
    Metadata {
        /// Key of the entry.
        key: String,
        /// Description of the valid values.
        expected: String,
        /// Value found.
        actual: String,
    },
    /// A tensor is missing, unknown or invalid.
    #[error("tensor {name}: expected {expected}, got {actual}")]
    Tensor {
        /// Name of the tensor.
        name: String,
        /// Description of the valid tensor.
        expected: String,
        /// Description of the tensor found.
        actual: String,
    },
}

/// Parses a file as described by [`PolicyModel::from_bytes`].
pub(super) fn read(bytes: &[u8]) -> Result<PolicyModel, PolicyError> {
    if bytes.len() > MAX_BYTES {
        let actual = bytes.len();
        return Err(PolicyError::TooLong { actual });
    }
    let file = File::open(bytes)?;
    file.check_keys()?;
    file.parsed("format", &format!("{FORMAT:?}"), |text| {
        (text == FORMAT).then_some(())
    })?;
    let activation = file.parsed("activation", "\"tanh\" or \"relu\"", |text| match text {
        "tanh" => Some(Activation::Tanh),
        "relu" => Some(Activation::Relu),
        _ => None,
    })?;
    let elements = format!("a number of elements from 1 to {MAX_ELEMENTS}");
    let elements = file.parsed("elements", &elements, |text| {
        text.parse().ok().filter(|e| (1..=MAX_ELEMENTS).contains(e))
    })?;
    let speed = format!("a speed from 0 to {MAX_RESIDUAL_SPEED} m/s");
    let residual_speed = file.parsed("residual_speed", &speed, |text| {
        let speed: f64 = text.parse().ok()?;
        (0.0..=MAX_RESIDUAL_SPEED).contains(&speed).then_some(speed)
    })?;
    let joints = match file.has("joints") {
        false => USUAL_JOINTS,
        true => {
            let joints = format!("a number of joints from 1 to {MAX_JOINTS}");
            file.parsed("joints", &joints, |text| {
                text.parse().ok().filter(|j| (1..=MAX_JOINTS).contains(j))
            })?
        }
    };
    let layout = ObservationLayout { elements, joints };
    let network = file.network(activation, layout.len())?;
    Ok(PolicyModel {
        layout,
        residual_speed,
        network,
    })
}

/// Header and data of a policy file.
struct File<'a> {
    header: Metadata,
    data: &'a [u8],
}

impl<'a> File<'a> {
    fn open(bytes: &'a [u8]) -> Result<Self, PolicyError> {
        let opened = SafeTensors::read_metadata(bytes);
        let (length, header) = opened.map_err(|source| PolicyError::Container { source })?;
        // The header's length comes first, in eight bytes.
        let data = bytes.get(8 + length..).unwrap_or_default();
        Ok(Self { header, data })
    }

    /// Rejects unknown metadata keys.
    fn check_keys(&self) -> Result<(), PolicyError> {
        let keys = self.header.metadata().iter().flatten().map(|(key, _)| key);
        match keys.filter(|key| !KEYS.contains(&key.as_str())).min() {
            None => Ok(()),
            Some(key) => Err(PolicyError::Metadata {
                key: key.clone(),
                expected: KEYS.join(", "),
                actual: "an unknown entry".into(),
            }),
        }
    }

    /// `true` if the metadata has an entry `key`.
    fn has(&self, key: &str) -> bool {
        let metadata = self.header.metadata().as_ref();
        metadata.is_some_and(|metadata| metadata.contains_key(key))
    }

    /// Parses an entry of the metadata with `parse`.
    fn parsed<T>(
        &self,
        key: &str,
        expected: &str,
        parse: impl Fn(&str) -> Option<T>,
    ) -> Result<T, PolicyError> {
        let metadata = self.header.metadata().as_ref();
        let text = metadata.and_then(|metadata| metadata.get(key));
        text.and_then(|text| parse(text))
            .ok_or_else(|| PolicyError::Metadata {
                key: key.to_string(),
                expected: expected.to_string(),
                actual: text.map_or_else(|| "missing".to_string(), |text| format!("{text:?}")),
            })
    }

    fn network(&self, activation: Activation, inputs: usize) -> Result<Network, PolicyError> {
        let mut names = vec!["input.mean".to_string(), "input.scale".to_string()];
        let mean = self.numbers(&names[0], &[inputs], -LARGEST)?;
        let scale = self.numbers(&names[1], &[inputs], SMALLEST_SCALE)?;
        let has = |layer: &usize| self.header.info(&format!("layer{layer}.weight")).is_some();
        let count = (0..MAX_LAYERS).take_while(has).count().max(1);
        let (mut layers, mut width) = (Vec::new(), inputs);
        for layer in 0..count {
            let [weight, bias] = ["weight", "bias"].map(|part| format!("layer{layer}.{part}"));
            let outputs = match layer + 1 == count {
                true => OUTPUTS,
                false => self.width(&weight)?,
            };
            let weights = self.numbers(&weight, &[outputs, width], -LARGEST)?;
            let biases = self.numbers(&bias, &[outputs], -LARGEST)?;
            layers.push(Layer::new(width, &weights, &biases));
            names.extend([weight, bias]);
            width = outputs;
        }
        let tensors = self.header.offset_keys();
        match tensors.into_iter().find(|name| !names.contains(name)) {
            None => Ok(Network {
                mean,
                scale,
                activation,
                layers,
            }),
            Some(name) => Err(PolicyError::Tensor {
                name,
                expected: format!("only {}; up to {MAX_LAYERS} layers", names.join(", ")),
                actual: "an unknown tensor".into(),
            }),
        }
    }

    /// Number of outputs of a hidden layer, from the shape of the tensor `weights`.
    fn width(&self, weights: &str) -> Result<usize, PolicyError> {
        let shape = self.header.info(weights).map_or(&[][..], |t| &t.shape);
        let width = shape.first().copied().unwrap_or_default();
        let wrong = || PolicyError::Tensor {
            name: weights.to_string(),
            expected: format!("1 to {MAX_WIDTH} outputs"),
            actual: format!("shape {shape:?}"),
        };
        let good = (1..=MAX_WIDTH).contains(&width);
        good.then_some(width).ok_or_else(wrong)
    }

    /// Returns the values of a tensor with this shape. Each must be between `least` and [`LARGEST`].
    fn numbers(&self, name: &str, shape: &[usize], least: f32) -> Result<Vec<f32>, PolicyError> {
        let wrong = |expected: String, actual: String| PolicyError::Tensor {
            name: name.to_string(),
            expected,
            actual,
        };
        let expected = || format!("F32 of shape {shape:?}");
        let tensor = self.header.info(name);
        let tensor = tensor.ok_or_else(|| wrong(expected(), "missing".into()))?;
        if tensor.dtype != Dtype::F32 || tensor.shape != shape {
            let actual = format!("{:?} of shape {:?}", tensor.dtype, tensor.shape);
            return Err(wrong(expected(), actual));
        }
        let (start, end) = tensor.data_offsets;
        let (numbers, _) = self.data.get(start..end).unwrap_or_default().as_chunks();
        let numbers: Vec<f32> = numbers.iter().map(|&n| f32::from_le_bytes(n)).collect();
        let good = |number: &f32| (least..=LARGEST).contains(number);
        match numbers.iter().position(|number| !good(number)) {
            None => Ok(numbers),
            Some(at) => Err(wrong(
                format!("numbers from {least:e} to {LARGEST:e}"),
                format!("{} at index {at}", numbers[at]),
            )),
        }
    }
}
