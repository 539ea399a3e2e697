//! Contents of a policy file, from which tests and benchmarks write valid and invalid files.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use safetensors::tensor::{Dtype, TensorView, serialize};
use std::collections::BTreeMap;

/// Number of observed values other than the three per element.
const BESIDE_FORCES: usize = 21;

/// Contents of a policy file.
#[derive(Debug, Clone)]
pub struct PolicyFile {
    pub metadata: BTreeMap<String, String>,
    /// Shape and numbers by name.
    pub tensors: BTreeMap<String, (Vec<usize>, Vec<f32>)>,
}

impl PolicyFile {
    /// Creates a policy with zero weights and biases and identity normalization. `hidden` contains the number of
    /// outputs of each layer except the last.
    pub fn zero(elements: usize, hidden: &[usize]) -> Self {
        let inputs = 3 * elements + BESIDE_FORCES;
        let metadata = [
            ("format", "feeler-policy-1"),
            ("activation", "tanh"),
            ("elements", &elements.to_string()),
            ("residual_speed", "0.01"),
        ];
        let mut file = Self {
            metadata: metadata.map(|(k, v)| (k.into(), v.into())).into(),
            tensors: BTreeMap::new(),
        };
        file.put("input.mean", &[inputs], vec![0.0; inputs]);
        file.put("input.scale", &[inputs], vec![1.0; inputs]);
        let mut width = inputs;
        for (layer, &outputs) in hidden.iter().chain(&[3]).enumerate() {
            let weights = vec![0.0; outputs * width];
            file.put(&format!("layer{layer}.weight"), &[outputs, width], weights);
            let biases = vec![0.0; outputs];
            file.put(&format!("layer{layer}.bias"), &[outputs], biases);
            width = outputs;
        }
        file
    }

    /// Like [`zero`](Self::zero), but with random numbers that do not saturate a layer.
    pub fn drawn(elements: usize, hidden: &[usize], seed: u64) -> Self {
        let mut random = Pcg64::seed_from_u64(seed);
        let mut file = Self::zero(elements, hidden);
        for (name, (shape, numbers)) in &mut file.tensors {
            let (low, high) = match (name.as_str(), &shape[..]) {
                ("input.scale", _) => (0.5, 2.0),
                (_, &[_, inputs]) => (-(3.0 / inputs as f32).sqrt(), (3.0 / inputs as f32).sqrt()),
                _ => (-0.3, 0.3),
            };
            numbers.fill_with(|| random.random_range(low..high));
        }
        file
    }

    /// Replaces a tensor.
    pub fn put(&mut self, name: &str, shape: &[usize], numbers: Vec<f32>) {
        self.tensors.insert(name.into(), (shape.to_vec(), numbers));
    }

    /// Bytes of the file.
    pub fn bytes(&self) -> Vec<u8> {
        let little_endian =
            |numbers: &[f32]| -> Vec<u8> { numbers.iter().flat_map(|n| n.to_le_bytes()).collect() };
        let tensors = self.tensors.iter();
        let tensors: Vec<_> = tensors
            .map(|(name, (shape, numbers))| (name, shape, little_endian(numbers)))
            .collect();
        let views = tensors.iter().map(|(name, shape, bytes)| {
            let view = TensorView::new(Dtype::F32, shape.to_vec(), bytes);
            (
                name.as_str(),
                view.expect("as many numbers as the shape requires"),
            )
        });
        serialize(views, Some(self.metadata.clone().into_iter().collect())).expect("a file's bytes")
    }
}
