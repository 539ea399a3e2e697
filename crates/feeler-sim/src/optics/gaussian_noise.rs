//! Vectorized Gaussian random numbers, for the noise of directly sensed forces.

use multiversion::multiversion;
use rand::Rng;
use rand_pcg::Pcg64;
use std::f32::consts::{FRAC_PI_4, SQRT_2};

/// Number of pairs per block; one lane each.
const LANES: usize = 8;
/// Numbers per block.
pub const GAUSSIAN_BLOCK: usize = 2 * LANES;
/// Number of blocks that are computed together, to fill the widest vectors.
const BLOCKS: usize = 2;

type Words = [u32; LANES];

/// Generator of Gaussian numbers with mean 0 and standard deviation 1.
///
/// Each of eight lanes runs Xoshiro128++ (Blackman and Vigna 2021), followed by the Box-Muller transform in single
/// precision. Numbers have 24 bits and are limited to 5.77 standard deviations, which a Gaussian exceeds with
/// probability 8e-9. All operations are rounded alike on every machine, so results do not depend on the processor and
/// its vector width.
#[derive(Debug, Clone)]
pub struct GaussianNoise {
    state: [Words; 4],
}

impl GaussianNoise {
    /// Creates a generator with seeds from `rng`.
    pub fn new(rng: &mut Pcg64) -> Self {
        Self {
            state: [(); 4].map(|()| std::array::from_fn(|_| rng.next_u32())),
        }
    }

    /// Writes the next numbers. If the last block is not filled, its remaining numbers are discarded.
    pub fn fill(&mut self, numbers: &mut [f64]) {
        fill(&mut self.state, numbers);
    }
}

#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl", "x86_64+avx2"))]
fn fill(state: &mut [Words; 4], numbers: &mut [f64]) {
    let mut pieces = numbers.chunks_exact_mut(BLOCKS * GAUSSIAN_BLOCK);
    for piece in &mut pieces {
        piece.copy_from_slice(next_blocks::<{ BLOCKS * LANES }, BLOCKS>(state).as_flattened());
    }
    for piece in pieces.into_remainder().chunks_mut(GAUSSIAN_BLOCK) {
        let [block] = next_blocks::<LANES, 1>(state);
        piece.copy_from_slice(&block[..piece.len()]);
    }
}

// The loops over lane indices below are vectorized by the compiler.

/// Computes the next `COUNT` blocks, with `ALL` lanes in total.
#[inline(always)]
fn next_blocks<const ALL: usize, const COUNT: usize>(
    state: &mut [Words; 4],
) -> [[f64; GAUSSIAN_BLOCK]; COUNT] {
    let (mut first, mut second) = ([0; ALL], [0; ALL]);
    for block in 0..COUNT {
        first[LANES * block..][..LANES].copy_from_slice(&next_words(state));
        second[LANES * block..][..LANES].copy_from_slice(&next_words(state));
    }
    let radii = radii(&first);
    let (cosines, sines) = directions(&second);
    let mut blocks = [[0.0; GAUSSIAN_BLOCK]; COUNT];
    for (block, numbers) in blocks.iter_mut().enumerate() {
        for lane in 0..LANES {
            let of_all = LANES * block + lane;
            numbers[lane] = f64::from(radii[of_all] * cosines[of_all]);
            numbers[LANES + lane] = f64::from(radii[of_all] * sines[of_all]);
        }
    }
    blocks
}

/// Xoshiro128++.
#[inline(always)]
fn next_words(state: &mut [Words; 4]) -> Words {
    let [mut a, mut b, mut c, mut d] = *state;
    let mut words = [0; LANES];
    for lane in 0..LANES {
        let sum = a[lane].wrapping_add(d[lane]);
        words[lane] = sum.rotate_left(7).wrapping_add(a[lane]);
        let shifted = b[lane] << 9;
        c[lane] ^= a[lane];
        d[lane] ^= b[lane];
        b[lane] ^= c[lane];
        a[lane] ^= d[lane];
        c[lane] ^= shifted;
        d[lane] = d[lane].rotate_left(11);
    }
    *state = [a, b, c, d];
    words
}

/// sqrt(-2 ln u) for u uniform over the multiples of 2^-24 in (0, 1].
#[inline(always)]
fn radii<const ALL: usize>(words: &[u32; ALL]) -> [f32; ALL] {
    let mut radii = [0.0; ALL];
    for lane in 0..ALL {
        let uniform = 1.0 - (words[lane] >> 8) as i32 as f32 * 2.0_f32.powi(-24);
        radii[lane] = (-2.0 * logarithm(uniform)).sqrt();
    }
    radii
}

/// Cosines and sines of angles that are uniform over the circle. The lower 23 bits select the angle within an octant,
/// the next three bits the octant.
#[inline(always)]
fn directions<const ALL: usize>(words: &[u32; ALL]) -> ([f32; ALL], [f32; ALL]) {
    let (mut cosines, mut sines) = ([0.0; ALL], [0.0; ALL]);
    for lane in 0..ALL {
        let word = words[lane];
        let part = (word & 0x7f_ffff) as i32 as f32 + 0.5;
        let angle = part * (FRAC_PI_4 * 2.0_f32.powi(-23));
        let (cosine, sine) = (cosine(angle), sine(angle));
        let swap = word & 0x80_0000 != 0;
        let (x, y) = (
            if swap { sine } else { cosine },
            if swap { cosine } else { sine },
        );
        // Two more bits are the signs.
        cosines[lane] = f32::from_bits(x.to_bits() ^ ((word << 7) & 0x8000_0000));
        sines[lane] = f32::from_bits(y.to_bits() ^ ((word << 6) & 0x8000_0000));
    }
    (cosines, sines)
}

/// Natural logarithm of a positive number, with a relative error of 2e-7. Coefficients of the Cephes library (Moshier
/// 1992), `logf`.
#[inline(always)]
fn logarithm(number: f32) -> f32 {
    let bits = number.to_bits();
    let mantissa = f32::from_bits((bits & 0x7f_ffff) | 1.0_f32.to_bits());
    let exponent = ((bits >> 23) as i32 - 127) as f32;
    // Reduces the mantissa to within a factor of sqrt(2) of 1.
    let high = mantissa > SQRT_2;
    let x = if high { 0.5 * mantissa } else { mantissa } - 1.0;
    let exponent = exponent + if high { 1.0 } else { 0.0 };
    let mut p = 7.037_683_6e-2;
    p = p * x - 1.151_461e-1;
    p = p * x + 1.167_699_9e-1;
    p = p * x - 1.242_014_1e-1;
    p = p * x + 1.424_932_3e-1;
    p = p * x - 1.666_805_8e-1;
    p = p * x + 2.000_071_5e-1;
    p = p * x - 2.499_999_4e-1;
    p = p * x + 3.333_333e-1;
    let square = x * x;
    // ln 2 is split into two parts; the first, 355 / 512, is exact.
    let small = p * x * square - 2.121_944_4e-4 * exponent - 0.5 * square;
    x + small + (355.0 / 512.0) * exponent
}

/// Sine of an angle from 0 to π/4, to 1e-7. Coefficients of the Cephes library, `sinf`.
#[inline(always)]
fn sine(angle: f32) -> f32 {
    let square = angle * angle;
    let p = (-1.951_529_6e-4 * square + 8.332_161e-3) * square - 1.666_665_5e-1;
    angle + angle * square * p
}

/// Cosine of an angle from 0 to π/4, to 1e-7. Coefficients of the Cephes library, `cosf`.
#[inline(always)]
fn cosine(angle: f32) -> f32 {
    let square = angle * angle;
    let p = (2.443_315_7e-5 * square - 1.388_731_6e-3) * square + 4.166_664_6e-2;
    1.0 - 0.5 * square + square * square * p
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_xoshiro::Xoshiro128PlusPlus;

    /// The first `count` numbers of `seed`.
    fn numbers(seed: u64, count: usize) -> Vec<f64> {
        let mut numbers = vec![0.0; count];
        GaussianNoise::new(&mut Pcg64::seed_from_u64(seed)).fill(&mut numbers);
        numbers
    }

    #[test]
    fn every_lane_matches_xoshiro128_plus_plus() {
        let seed: [Words; 4] = std::array::from_fn(|part| {
            std::array::from_fn(|lane| {
                0x9e37_79b9_u32.wrapping_mul((1 + part * LANES + lane) as u32)
            })
        });
        let mut lanes = seed;
        let mut alone: Vec<_> = (0..LANES)
            .map(|lane| {
                let bytes = seed.map(|part| part[lane].to_le_bytes()).concat();
                Xoshiro128PlusPlus::from_seed(bytes.try_into().expect("sixteen bytes"))
            })
            .collect();
        for _ in 0..1000 {
            let words = next_words(&mut lanes);
            for (word, alone) in words.iter().zip(&mut alone) {
                assert_eq!(*word, alone.next_u32());
            }
        }
    }

    #[test]
    fn functions_match_the_standard_library() {
        for step in 1..=10_000 {
            let (angle, number) = (FRAC_PI_4 * step as f32 / 1e4, step as f32 / 1e4);
            // A few rounding errors of 6e-8 for numbers up to 1.
            assert!((f64::from(sine(angle)) - f64::from(angle).sin()).abs() < 1.5e-7);
            assert!((f64::from(cosine(angle)) - f64::from(angle).cos()).abs() < 1.5e-7);
            let expected = f64::from(number).ln();
            let error = (f64::from(logarithm(number)) - expected).abs();
            assert!(
                error <= 2e-7 * expected.abs(),
                "{number}: {error} of {expected}"
            );
        }
        let least = 2.0_f32.powi(-24);
        assert!((logarithm(least) + 24.0 * 2.0_f32.ln()).abs() < 2e-6);
    }

    /// Two-sided tail probabilities of a Gaussian, erfc(x / sqrt(2)), from tables.
    const BEYOND: [(f64, f64); 6] = [
        (0.5, 0.617_075_1),
        (1.0, 0.317_310_5),
        (2.0, 0.045_500_3),
        (3.0, 2.699_796e-3),
        (4.0, 6.334_248e-5),
        (4.5, 6.795_346e-6),
    ];

    #[test]
    fn distribution_is_gaussian_up_to_its_tails() {
        let count = 1 << 23;
        let numbers = numbers(3, count);
        let mean = numbers.iter().sum::<f64>() / count as f64;
        let moment = |power| numbers.iter().map(|x| x.powi(power)).sum::<f64>() / count as f64;
        // Four standard errors: the variances of the powers are 1, 2, 15 and 96.
        let error = |variance: f64| 4.0 * (variance / count as f64).sqrt();
        assert!(mean.abs() < error(1.0), "mean {mean}");
        assert!((moment(2) - 1.0).abs() < error(2.0), "{}", moment(2));
        assert!(moment(3).abs() < error(15.0), "{}", moment(3));
        assert!((moment(4) - 3.0).abs() < error(96.0), "{}", moment(4));
        for (beyond, expected) in BEYOND {
            let share = numbers.iter().filter(|x| x.abs() > beyond).count() as f64 / count as f64;
            let bound = 4.0 * (expected * (1.0 - expected) / count as f64).sqrt();
            assert!((share - expected).abs() < bound, "{beyond}: {share}");
            let above = numbers.iter().filter(|x| **x > beyond).count() as f64 / count as f64;
            assert!(
                (above - expected / 2.0).abs() < bound,
                "above {beyond}: {above}"
            );
        }
    }

    #[test]
    fn numbers_are_independent_across_lags_and_seeds() {
        let count = 1 << 20;
        let (one, other) = (numbers(11, count), numbers(12, count));
        let check = |a: &[f64], b: &[f64], what: &str| {
            let mean = |power: i32| {
                let products = a.iter().zip(b).map(|(a, b)| (a * b).powi(power));
                products.sum::<f64>() / count as f64
            };
            // Four standard errors; the square of the product has mean 1 and variance 8.
            let error = 4.0 / (count as f64).sqrt();
            assert!(mean(1).abs() < error, "{what}: {}", mean(1));
            assert!(
                (mean(2) - 1.0).abs() < error * 8.0_f64.sqrt() + 1e-4,
                "{what}: {}",
                mean(2)
            );
        };
        for lag in [1, 2, 3, LANES, GAUSSIAN_BLOCK, 123, 128] {
            check(&one, &one[lag..], &format!("lag {lag}"));
        }
        check(&one, &other, "another seed");
    }

    #[test]
    fn numbers_do_not_depend_on_buffer_length_or_vector_width() {
        let whole = numbers(5, 8 * GAUSSIAN_BLOCK);
        let mut noise = GaussianNoise::new(&mut Pcg64::seed_from_u64(5));
        let mut first = vec![0.0; 2 * GAUSSIAN_BLOCK + 3];
        noise.fill(&mut first);
        assert_eq!(first, whole[..first.len()]);
        let mut state = GaussianNoise::new(&mut Pcg64::seed_from_u64(5)).state;
        for block in whole.chunks_exact(GAUSSIAN_BLOCK) {
            assert_eq!(next_blocks::<LANES, 1>(&mut state), [block]);
        }
    }
}
