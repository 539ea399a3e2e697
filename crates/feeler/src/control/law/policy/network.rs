//! A network of dense layers, evaluated without allocation and in the same order of operations on every processor.

use super::tanh::tanh;
use multiversion::multiversion;

/// Number of outputs of a layer that are accumulated together: as many as fit into vector registers while all inputs
/// are processed.
const LANES: usize = 32;

/// Values of [`LANES`] neurons.
type Block = [f32; LANES];

/// Maximum magnitude of all numbers in a network file and of all values between two layers, so that no sum overflows.
pub(super) const LARGEST: f32 = 1e6;

/// Activation function between two layers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Activation {
    /// The hyperbolic tangent.
    Tanh,
    /// Positive part (rectified linear unit), at most 1e6.
    Relu,
}

/// A fully connected layer.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layer {
    inputs: usize,
    /// Weights: for each block of outputs, one row per input. Zero beyond the last output.
    weights: Vec<Block>,
    biases: Vec<Block>,
}

impl Layer {
    /// Creates a layer from weights in C order, `[biases.len(), inputs]`.
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

/// Input normalisation and layers.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Network {
    /// Mean subtracted from each input.
    pub mean: Vec<f32>,
    /// Divisor of each input after subtracting the mean.
    pub scale: Vec<f32>,
    pub activation: Activation,
    pub layers: Vec<Layer>,
}

/// Preallocated buffers for evaluating a network.
#[derive(Debug, Clone)]
pub(super) struct Scratch {
    inputs: Vec<f32>,
    /// Input and output of a layer.
    values: [Vec<Block>; 2],
}

impl Scratch {
    /// Inputs of the next evaluation; their number is that of the means.
    pub fn inputs_mut(&mut self) -> &mut [f32] {
        &mut self.inputs
    }
}

impl Network {
    /// Allocates buffers for evaluating the network.
    pub fn scratch(&self) -> Scratch {
        let widths = self.layers.iter().map(|layer| layer.biases.len());
        let zeros = vec![[0.0; LANES]; widths.fold(1, usize::max)];
        Scratch {
            inputs: vec![0.0; self.mean.len()],
            values: [zeros.clone(), zeros],
        }
    }

    /// Returns the first three outputs of the last layer for the inputs in `scratch`, which are overwritten. The
    /// outputs are finite if the inputs are.
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

/// Computes `outputs = weights inputs + biases` with the widest vector instructions of the processor. Products are
/// rounded and then summed in the order of the inputs, so that all instruction sets give the same result.
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
