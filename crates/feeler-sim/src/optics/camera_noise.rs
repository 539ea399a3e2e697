//! Camera noise, fast enough for every pixel of every frame.

use rand::Rng;
use rand_pcg::Pcg64;

/// Number of pixels per block.
pub const NOISE_LANES: usize = 16;

/// Approximately Gaussian noise for the pixels of one image, [`NOISE_LANES`] at a time, in any order.
///
/// A sample is the sum of the four bytes of a word: approximately Gaussian by the central limit theorem, with mean 510,
/// variance 4 (256² - 1) / 12, and no sample beyond 3.45 standard deviations. A Feistel network computes the word from
/// the index of the pixel's block and a seed per lane and image. It uses only 16-bit integer operations, so results are
/// equal on all machines, and one 256-bit vector contains all lanes.
#[derive(Debug, Clone)]
pub struct PictureNoise {
    seeds: [[u16; NOISE_LANES]; 2],
}

/// Mean of the sum of four bytes.
const BYTE_SUM_MEAN: i16 = 510;
/// Standard deviation of the sum of four bytes, sqrt(4 (256² - 1) / 12).
pub const BYTE_SUM_DEVIATION: f32 = 147.801_22;
/// Multipliers of the rounds of the Feistel network. With three rounds, the spectrum of the noise has lines; with four,
/// it is white.
const ROUNDS: [u16; 4] = [0x9e37, 0x85eb, 0xc2b3, 0x27d5];

impl PictureNoise {
    /// Creates the noise of one image, with seeds from `rng`.
    pub fn new(rng: &mut Pcg64) -> Self {
        Self {
            seeds: [(); 2].map(|()| std::array::from_fn(|_| rng.next_u32() as u16)),
        }
    }

    /// Samples of a block of pixels: mean 0, standard deviation [`BYTE_SUM_DEVIATION`].
    #[inline(always)]
    pub fn of_block(&self, block: usize) -> [i16; NOISE_LANES] {
        let [mut left, mut right] = self.seeds;
        for lane in 0..NOISE_LANES {
            left[lane] = left[lane].wrapping_add((block >> 16) as u16);
            right[lane] = right[lane].wrapping_add(block as u16);
        }
        for factor in ROUNDS {
            for lane in 0..NOISE_LANES {
                // The high and low half of the product are one SIMD instruction each.
                let high = (u32::from(right[lane]) * u32::from(factor)) >> 16;
                let mixed = right[lane].wrapping_mul(factor) ^ high as u16;
                (left[lane], right[lane]) = (right[lane], left[lane] ^ mixed);
            }
        }
        let mut samples = [0; NOISE_LANES];
        for lane in 0..NOISE_LANES {
            let (left, right) = (left[lane], right[lane]);
            let sum = (left & 0xff) + (left >> 8) + (right & 0xff) + (right >> 8);
            samples[lane] = sum as i16 - BYTE_SUM_MEAN;
        }
        samples
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    /// The first `count` samples of an image, divided by their standard deviation.
    fn samples(seed: u64, count: usize) -> Vec<f32> {
        let noise = PictureNoise::new(&mut Pcg64::seed_from_u64(seed));
        let blocks = (0..count / NOISE_LANES).flat_map(|block| noise.of_block(block));
        blocks
            .map(|sample| f32::from(sample) / BYTE_SUM_DEVIATION)
            .collect()
    }

    #[test]
    fn samples_have_mean_0_and_variance_1() {
        let count = 1 << 20;
        let samples = samples(7, count);
        let mean = samples.iter().map(|&s| f64::from(s)).sum::<f64>() / count as f64;
        let variance = samples.iter().map(|&s| f64::from(s).powi(2)).sum::<f64>() / count as f64;
        // Four standard errors: 1/sqrt(n) for the mean, sqrt(2/n) for the variance of a Gaussian.
        assert!(mean.abs() < 4.0 / 1024.0, "mean {mean}");
        assert!(
            (variance - 1.0).abs() < 4.0 * 2.0_f64.sqrt() / 1024.0,
            "variance {variance}"
        );
    }

    #[test]
    fn samples_of_neighbours_and_of_other_images_are_uncorrelated() {
        let count = 1 << 20;
        let (one, other) = (samples(11, count), samples(12, count));
        let correlation = |a: &[f32], b: &[f32]| {
            let products = a.iter().zip(b).map(|(a, b)| f64::from(a * b));
            products.sum::<f64>() / count as f64
        };
        for lag in [1, 2, 8, NOISE_LANES, 2 * NOISE_LANES, 640, 640 * 480] {
            let correlation = correlation(&one, &one[lag..]);
            // Four standard errors.
            assert!(correlation.abs() < 4.0 / 1024.0, "lag {lag}: {correlation}");
        }
        let correlation = correlation(&one, &other);
        assert!(correlation.abs() < 4.0 / 1024.0, "{correlation}");
    }

    #[test]
    fn samples_are_distributed_as_a_sum_of_four_bytes() {
        let count = 1 << 20;
        let seen = samples(5, count);
        let share = |below: f32| {
            let below = seen.iter().filter(|&&sample| sample < below);
            below.count() as f64 / count as f64
        };
        // Exact distribution, by counting all sums of four bytes.
        let mut ways = vec![1.0];
        for _ in 0..4 {
            let mut next = vec![0.0; ways.len() + 255];
            for (sum, ways) in ways.iter().enumerate() {
                next[sum..sum + 256]
                    .iter_mut()
                    .for_each(|next| *next += ways);
            }
            ways = next;
        }
        for sum in [60, 200, 350, 450, 510, 570, 700, 900] {
            let expected = ways[..sum].iter().sum::<f64>() / 256.0_f64.powi(4);
            let got = share((sum as f32 - f32::from(BYTE_SUM_MEAN)) / BYTE_SUM_DEVIATION);
            // Four standard errors.
            let bound = 4.0 * (expected * (1.0 - expected) / count as f64).sqrt();
            assert!(
                (got - expected).abs() < bound,
                "{sum}: {got}, not {expected}"
            );
        }
    }
}
