//! Scale space of an image, to detect blobs of any size.

use super::reference::ReferencePicture;
use multiversion::multiversion;

/// Ratio of each scale to the previous one.
const STEP: f64 = 1.189_207_115_002_721; // fourth root of 2

/// Finest scale, px: the scale of a spot with a diameter of two pixels.
const FINEST: f64 = 0.8;

/// Scale, in pixels of the current layer, at which the resolution is halved; smoother layers need fewer pixels.
const COARSEST_IN_PIXELS: f64 = 3.2;

/// Blob response of the image at one scale.
#[derive(Debug, Clone)]
pub(super) struct Layer {
    /// Standard deviation of the Gaussian, in pixels of the image.
    pub sigma: f64,
    /// Distance between adjacent values, in pixels of the image.
    pub step: usize,
    /// Number of columns and rows of values.
    pub size: (usize, usize),
    /// `-sigma² ∇² (G * picture)`, gray levels: positive at bright blobs.
    pub response: Vec<f32>,
}

impl Layer {
    /// Maximum of the values at an image pixel and its four neighbours.
    fn around(&self, column: usize, row: usize) -> f32 {
        let (width, height) = self.size;
        // The layer ends within one value of the image's end.
        let column = (column / self.step).clamp(1, width - 2);
        let row = (row / self.step).clamp(1, height - 2);
        let index = row * width + column;
        [index - width, index - 1, index, index + 1, index + width]
            .iter()
            .fold(f32::NEG_INFINITY, |m, &i| m.max(self.response[i]))
    }
}

/// Blob responses from fine to coarse scales.
#[derive(Debug, Clone)]
pub(super) struct ScaleSpace {
    pub layers: Vec<Layer>,
}

impl ScaleSpace {
    /// Computes the layers of `picture` up to the scale `coarsest`, px.
    pub fn new(picture: &ReferencePicture, coarsest: f64) -> Self {
        let mut size = (picture.width, picture.height);
        let mut blurred = picture.gray.clone();
        let (mut sigma, mut have, mut step) = (FINEST, 0.0_f64, 1);
        let mut layers = Vec::new();
        while layers.len() < 3 || sigma <= coarsest {
            let more = (sigma * sigma - have * have).sqrt() / step as f64;
            blurred = blur(&blurred, size.0, size.1, more);
            have = sigma;
            // A smaller layer would have no inner values.
            let halved = (size.0.div_ceil(2), size.1.div_ceil(2));
            if sigma >= COARSEST_IN_PIXELS * step as f64 && halved.0.min(halved.1) >= 8 {
                blurred = every_second(&blurred, size);
                (size, step) = (halved, 2 * step);
            }
            layers.push(Layer {
                sigma,
                step,
                size,
                response: response(&blurred, size.0, size.1, sigma / step as f64),
            });
            sigma *= STEP;
        }
        Self { layers }
    }

    /// Inverts the sign of all responses, as for the inverted image.
    pub fn negated(mut self) -> Self {
        for layer in &mut self.layers {
            layer.response.iter_mut().for_each(|value| *value = -*value);
        }
        self
    }

    /// Returns the indices of values above `floor` that are maxima among their eight neighbours and in comparison with
    /// the adjacent layers, if any. Excludes the border.
    pub fn maxima(&self, layer: usize, floor: f32) -> Vec<usize> {
        let own = &self.layers[layer];
        let (width, height) = own.size;
        let below = layer.checked_sub(1).and_then(|l| self.layers.get(l));
        let above = self.layers.get(layer + 1);
        let mut found = Vec::new();
        for row in 1..height - 1 {
            for column in 1..width - 1 {
                let index = row * width + column;
                let value = own.response[index];
                if value <= floor || !largest_of_nine(&own.response, width, index) {
                    continue;
                }
                let place = (column * own.step, row * own.step);
                let mut beside = [below, above].into_iter().flatten();
                if beside.all(|l| l.around(place.0, place.1) <= value) {
                    found.push(index);
                }
            }
        }
        found
    }
}

/// Blob response of an image of `size` pixels at scale `sigma`, px.
pub(super) fn blurred_response(picture: &[f32], size: (usize, usize), sigma: f64) -> Layer {
    let blurred = blur(picture, size.0, size.1, sigma);
    Layer {
        sigma,
        step: 1,
        size,
        response: response(&blurred, size.0, size.1, sigma),
    }
}

/// Downsamples by two: keeps every second column of every second row.
fn every_second(values: &[f32], (width, _): (usize, usize)) -> Vec<f32> {
    let rows = values.chunks_exact(width).step_by(2);
    rows.flat_map(|row| row.iter().step_by(2).copied())
        .collect()
}

/// Returns `true` if a value is the maximum of its 3x3 neighbourhood; among equal values, only the first.
fn largest_of_nine(values: &[f32], width: usize, index: usize) -> bool {
    let value = values[index];
    let before = [
        index - width - 1,
        index - width,
        index - width + 1,
        index - 1,
    ];
    let after = [
        index + 1,
        index + width - 1,
        index + width,
        index + width + 1,
    ];
    before.iter().all(|&i| values[i] < value) && after.iter().all(|&i| values[i] <= value)
}

/// Computes the response `-sigma² ∇²` of a blurred image.
#[multiversion(targets("x86_64+avx2"))]
fn response(blurred: &[f32], width: usize, height: usize, sigma: f64) -> Vec<f32> {
    let scale = -(sigma * sigma) as f32;
    let mut response = vec![0.0; blurred.len()];
    for (row, response) in response.chunks_exact_mut(width).enumerate() {
        let up = &blurred[row.saturating_sub(1) * width..][..width];
        let down = &blurred[(row + 1).min(height - 1) * width..][..width];
        let own = &blurred[row * width..][..width];
        let at = |column: usize, left: usize, right: usize| {
            let sum = up[column] + down[column] + own[left] + own[right];
            scale * (sum - 4.0 * own[column])
        };
        for (column, value) in response.iter_mut().enumerate().take(width - 1).skip(1) {
            *value = at(column, column - 1, column + 1);
        }
        response[0] = at(0, 0, 1.min(width - 1));
        response[width - 1] = at(width - 1, width.saturating_sub(2), width - 1);
    }
    response
}

/// Blurs by a Gaussian of `sigma`, px. The border pixels are repeated beyond the image.
pub(super) fn blur(picture: &[f32], width: usize, height: usize, sigma: f64) -> Vec<f32> {
    let kernel = gaussian(sigma);
    let rows = blur_rows(picture, width, &kernel);
    blur_columns(&rows, width, height, &kernel)
}

/// Half of a normalized Gaussian kernel, from its middle outward.
fn gaussian(sigma: f64) -> Vec<f32> {
    let reach = (4.0 * sigma).ceil() as usize + 1;
    let weights: Vec<f64> = (0..=reach)
        .map(|i| libm::exp(-0.5 * (i as f64 / sigma).powi(2)))
        .collect();
    let sum = 2.0 * weights.iter().sum::<f64>() - weights[0];
    weights.iter().map(|w| (w / sum) as f32).collect()
}

#[multiversion(targets("x86_64+avx2"))]
fn blur_rows(picture: &[f32], width: usize, kernel: &[f32]) -> Vec<f32> {
    let reach = kernel.len() - 1;
    let mut blurred = Vec::with_capacity(picture.len());
    let mut padded = vec![0.0; width + 2 * reach];
    for row in picture.chunks_exact(width) {
        padded[..reach].fill(row[0]);
        padded[reach..reach + width].copy_from_slice(row);
        padded[reach + width..].fill(row[width - 1]);
        let start = blurred.len();
        blurred.extend(row.iter().map(|v| v * kernel[0]));
        for (i, weight) in kernel.iter().enumerate().skip(1) {
            let left = &padded[reach - i..][..width];
            let right = &padded[reach + i..][..width];
            for ((sum, l), r) in blurred[start..].iter_mut().zip(left).zip(right) {
                *sum += weight * (l + r);
            }
        }
    }
    blurred
}

/// Number of columns processed at once, so that their rows stay in the cache.
const BLOCK: usize = 512;

#[multiversion(targets("x86_64+avx2"))]
fn blur_columns(picture: &[f32], width: usize, height: usize, kernel: &[f32]) -> Vec<f32> {
    let mut blurred = vec![0.0; picture.len()];
    for first in (0..width).step_by(BLOCK) {
        let columns = first..(first + BLOCK).min(width);
        for row in 0..height {
            let of_row = |row: usize| &picture[row * width..][columns.clone()];
            let sums = &mut blurred[row * width..][columns.clone()];
            for (sum, value) in sums.iter_mut().zip(of_row(row)) {
                *sum = value * kernel[0];
            }
            for (i, weight) in kernel.iter().enumerate().skip(1) {
                let up = of_row(row.saturating_sub(i));
                let down = of_row((row + i).min(height - 1));
                for ((sum, u), d) in sums.iter_mut().zip(up).zip(down) {
                    *sum += weight * (u + d);
                }
            }
        }
    }
    blurred
}
