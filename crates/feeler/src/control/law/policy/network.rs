//! A network of dense layers, evaluated without allocation, in the same order of operations whatever the processor.

use super::tanh::tanh;
use multiversion::multiversion;

/// Outputs of a layer that are summed up together: as many as wide registers hold while all inputs pass by.
const LANES: usize = 32;

/// Values of as many neurons.
type Block = [f32; LANES];

/// No number of a network's file is larger, and no value between two layers becomes larger, so that no sum overflows.
pub(super) const LARGEST: f32 = 1e6;

/// What stands between two layers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Activation {
    /// The hyperbolic tangent.
    Tanh,
    /// The positive part, up to 1e6.
    Relu,
}

/// A layer each of whose outputs depends on all inputs.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layer {
    inputs: usize,
    /// For each block of outputs a row for each input; zero beyond the last output.
    weights: Vec<Block>,
    biases: Vec<Block>,
}

impl Layer {
    /// From weights in C order, `[biases.len(), inputs]`.
    pub fn new(inputs: usize, weights: &[f32], biases: &[f32]) -> Self {
        let blocks = biases.len().div_ceil(LANES);
        let mut layer = Self {
            inputs,
            weights: vec![[0.0; LANES]; blocks * inputs],
            biases: vec![[0.0; LANES]; blocks],
        };
        for (output, &bias) in biases.iter().enumerate() {
            layer.biases[output / LANES][output % LANES] = bias;
            for input in 0..inputs {
                let weight = weights[output * inputs + input];
                layer.weights[output / LANES * inputs + input][output % LANES] = weight;
            }
        }
        layer
    }
}

/// Normalisation and layers.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Network {
    /// Taken from each input.
    pub mean: Vec<f32>,
    /// What the rest is divided by.
    pub scale: Vec<f32>,
    pub activation: Activation,
    pub layers: Vec<Layer>,
}

/// Where a network is evaluated.
#[derive(Debug, Clone)]
pub(super) struct Scratch {
    inputs: Vec<f32>,
    /// What a layer takes, and what it gives.
    values: [Vec<Block>; 2],
}

impl Scratch {
    /// The inputs of the next evaluation, as many as there are means.
    pub fn inputs_mut(&mut self) -> &mut [f32] {
        &mut self.inputs
    }
}

impl Network {
    /// Memory to evaluate it in.
    pub fn scratch(&self) -> Scratch {
        let widths = self.layers.iter().map(|layer| layer.biases.len());
        let zeros = vec![[0.0; LANES]; widths.fold(1, usize::max)];
        Scratch {
            inputs: vec![0.0; self.mean.len()],
            values: [zeros.clone(), zeros],
        }
    }

    /// The first three outputs of the last layer for the inputs in `scratch`, which are used up; finite if those are.
    pub fn evaluate(&self, scratch: &mut Scratch) -> [f32; 3] {
        let Scratch {
            inputs,
            values: [values, next],
        } = scratch;
        normalise(inputs, &self.mean, &self.scale);
        let mut layers = self.layers.iter();
        if let Some(layer) = layers.next() {
            forward(&layer.weights, &layer.biases, inputs, values);
        }
        for layer in layers {
            let inputs = &mut values.as_flattened_mut()[..layer.inputs];
            activate(self.activation, inputs);
            forward(&layer.weights, &layer.biases, inputs, next);
            std::mem::swap(values, next);
        }
        let [first, second, third, ..] = values[0];
        [first, second, third]
    }
}

fn normalise(values: &mut [f32], mean: &[f32], scale: &[f32]) {
    for ((value, mean), scale) in values.iter_mut().zip(mean).zip(scale) {
        *value = ((*value - mean) / scale).clamp(-LARGEST, LARGEST);
    }
}

/// `outputs = weights inputs + biases`, with the widest instructions that the processor has. Products are summed up in the
/// order of the inputs, each rounded before, so that all give the same.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn forward(weights: &[Block], biases: &[Block], inputs: &[f32], outputs: &mut [Block]) {
    let blocks = weights.chunks_exact(inputs.len()).zip(biases);
    for ((rows, bias), output) in blocks.zip(outputs) {
        let mut sums = *bias;
        for (row, input) in rows.iter().zip(inputs) {
            for (sum, weight) in sums.iter_mut().zip(row) {
                *sum += weight * input;
            }
        }
        *output = sums;
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn activate(activation: Activation, values: &mut [f32]) {
    for value in values {
        *value = match activation {
            Activation::Tanh => tanh(*value),
            Activation::Relu => value.clamp(0.0, LARGEST),
        };
    }
}
