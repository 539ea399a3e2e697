//! The noise of a camera's picture, fast enough to be drawn for every pixel of every frame.

use rand::Rng;
use rand_pcg::Pcg64;

/// Pixels that are drawn side by side.
pub const NOISE_LANES: usize = 16;

/// [`NOISE_LANES`] generators of nearly Gaussian numbers, side by side.
///
/// Each is Marsaglia's 32-bit xorshift, seeded anew for every picture. A sample is the sum of the
/// four bytes of a word: by the central limit theorem close to a Gaussian, with mean 510, variance
/// 4 (256² - 1) / 12, and no sample beyond 3.45 standard deviations. Only integer operations and
/// single IEEE ones are used, so that the numbers are the same on every machine.
#[derive(Debug, Clone)]
pub struct NoiseLanes {
    state: [u32; NOISE_LANES],
    /// Samples that every generator has made or left out.
    made: usize,
}

/// Mean of the sum of four bytes.
const BYTE_SUM_MEAN: f32 = 510.0;
/// Standard deviation of the sum of four bytes, sqrt(4 (256² - 1) / 12).
const BYTE_SUM_DEVIATION: f32 = 147.801_22;

impl NoiseLanes {
    /// Generators that start where `rng` says.
    pub fn new(rng: &mut Pcg64) -> Self {
        // A xorshift generator never leaves 0, so that 0 is not a seed.
        Self {
            state: std::array::from_fn(|_| rng.next_u32().max(1)),
            made: 0,
        }
    }

    /// Leaves out what comes before the `next` sample of every generator, counted from the first, which is 0.
    #[inline(always)]
    pub fn skip_to(&mut self, next: usize) {
        for _ in self.made..next {
            self.state = self.state.map(following);
        }
        self.made = self.made.max(next);
    }

    /// The next sample of every generator: mean 0, variance 1.
    #[inline(always)]
    pub fn sample(&mut self) -> [f32; NOISE_LANES] {
        let mut samples = [0.0; NOISE_LANES];
        self.made += 1;
        for (state, sample) in self.state.iter_mut().zip(&mut samples) {
            let word = following(*state);
            *state = word;
            let pairs = (word & 0x00ff_00ff) + ((word >> 8) & 0x00ff_00ff);
            let sum = ((pairs + (pairs >> 16)) & 0xffff) as i32;
            *sample = (sum as f32 - BYTE_SUM_MEAN) * (1.0 / BYTE_SUM_DEVIATION);
        }
        samples
    }
}

/// The state of a generator after `word`.
#[inline(always)]
fn following(mut word: u32) -> u32 {
    word ^= word << 13;
    word ^= word >> 17;
    word ^= word << 5;
    word
}

/// The nearest grey level, 0 to 255.
#[inline(always)]
pub fn quantised(gray: f32) -> u8 {
    let gray = if gray > 0.0 { gray } else { 0.0 };
    let gray = if gray < 255.0 { gray } else { 255.0 };
    // Adding 2^23 leaves the nearest integer in the lowest bits.
    (gray + 8_388_608.0).to_bits() as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    /// `pictures` times 480 rows of 640 samples, as a picture draws them.
    fn samples(seed: u64, count: usize) -> Vec<f32> {
        let mut lanes = NoiseLanes::new(&mut Pcg64::seed_from_u64(seed));
        (0..count / NOISE_LANES)
            .flat_map(|_| lanes.sample())
            .collect()
    }

    #[test]
    fn samples_have_mean_0_and_variance_1() {
        let count = 1 << 20;
        let samples = samples(7, count);
        let mean = samples.iter().map(|&s| f64::from(s)).sum::<f64>() / count as f64;
        let variance = samples.iter().map(|&s| f64::from(s).powi(2)).sum::<f64>() / count as f64;
        // Four standard errors: 1/sqrt(n) of the mean, sqrt(2/n) of a Gaussian's variance.
        assert!(mean.abs() < 4.0 / 1024.0, "mean {mean}");
        assert!(
            (variance - 1.0).abs() < 4.0 * 2.0_f64.sqrt() / 1024.0,
            "variance {variance}"
        );
    }

    #[test]
    fn neighbouring_samples_are_uncorrelated() {
        let count = 1 << 20;
        let samples = samples(11, count);
        for lag in [1, 2, NOISE_LANES, 2 * NOISE_LANES, 640] {
            let products = samples.iter().zip(&samples[lag..]);
            let correlation =
                products.map(|(a, b)| f64::from(a * b)).sum::<f64>() / (count - lag) as f64;
            // Four standard errors.
            assert!(correlation.abs() < 4.0 / 1024.0, "lag {lag}: {correlation}");
        }
    }

    #[test]
    fn samples_that_are_left_out_change_none_of_the_others() {
        let mut all = NoiseLanes::new(&mut Pcg64::seed_from_u64(3));
        let mut some = all.clone();
        let all: Vec<_> = (0..20).map(|_| all.sample()).collect();
        for next in [0, 1, 7, 19] {
            some.skip_to(next);
            assert_eq!(some.sample(), all[next]);
        }
    }

    #[test]
    fn gray_values_are_rounded_and_clipped() {
        let cases = [
            (-3.0, 0),
            (0.4, 0),
            (0.6, 1),
            (99.5, 100),
            (254.6, 255),
            (400.0, 255),
        ];
        for (gray, expected) in cases {
            assert_eq!(quantised(gray), expected, "{gray}");
        }
        assert_eq!(quantised(f32::NAN), 0);
    }
}
