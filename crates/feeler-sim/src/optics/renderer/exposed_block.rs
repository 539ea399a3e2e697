//! Gray levels and their noise for blocks of sixteen pixels.

use crate::optics::camera_noise::{BYTE_SUM_DEVIATION, NOISE_LANES};
use crate::optics::config::OpticsConfig;

/// Gray levels of a block and their noise in 16-bit integers; a 256-bit vector contains all sixteen.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ExposedBlock {
    /// Means in units of 1 / [`PARTS`] gray level, plus half a level, so that truncation rounds to nearest.
    means: [i16; NOISE_LANES],
    /// Standard deviations in units of 1 / [`DEVIATION_UNIT`] gray level.
    deviations: [i16; NOISE_LANES],
}

/// Fixed-point units per gray level.
const PARTS: i16 = 1 << PART_BITS;
const PART_BITS: u32 = 7;
/// Left shift of samples, so that they use 16 bits.
const SAMPLE_SHIFT: u32 = 6;
/// Fixed-point units of a standard deviation per gray level. Its product with a shifted sample is 2^16 times the noise
/// in units of 1 / [`PARTS`]. Deviations up to 36 levels fit into 16 bits.
const DEVIATION_UNIT: f32 = PARTS as f32 / BYTE_SUM_DEVIATION * (1 << (16 - SAMPLE_SHIFT)) as f32;

impl ExposedBlock {
    /// Gray levels with the given samples of noise.
    #[inline(always)]
    pub fn noisy(&self, samples: &[i16; NOISE_LANES]) -> [u8; NOISE_LANES] {
        let mut grays = [0; NOISE_LANES];
        for lane in 0..NOISE_LANES {
            let sample = samples[lane] << SAMPLE_SHIFT;
            // The high half of the product is one SIMD instruction.
            let noise = (i32::from(sample) * i32::from(self.deviations[lane])) >> 16;
            let gray = self.means[lane].saturating_add(noise as i16) >> PART_BITS;
            grays[lane] = gray.clamp(0, 255) as u8;
        }
        grays
    }
}

/// Rounds `value`, from 0 to 32767, to an integer; 0 for NaN.
#[inline(always)]
fn whole(value: f32) -> i16 {
    // Adding 2^23 leaves the nearest integer in the low bits.
    (value + 8_388_608.0).to_bits() as i16
}

/// Exposure parameters that convert light to gray levels in a row of pixels.
pub(crate) struct Exposure {
    background: f32,
    contrast: f32,
    most_cover: f32,
    read_variance: f32,
    shot_variance: f32,
    lost_by_row: f32,
}

impl Exposure {
    /// Exposure parameters of a row of pixels that loses the fraction `lost_by_row` of its light to vignetting.
    #[inline(always)]
    pub fn new(config: &OpticsConfig, lost_by_row: f32) -> Self {
        Self {
            background: config.background_gray as f32,
            contrast: (config.spot_gray - config.background_gray) as f32,
            // Overlapping contacts do not add up; markers differ in brightness.
            most_cover: match config.markers {
                Some(_) => f32::INFINITY,
                None => 1.0,
            },
            read_variance: config.read_noise.powi(2) as f32,
            shot_variance: config.shot_noise.powi(2) as f32,
            lost_by_row,
        }
    }

    /// Gray levels and noise of a block of pixels with the light `lit`.
    #[inline(always)]
    pub fn expose(
        &self,
        lit: &[f32; NOISE_LANES],
        lost_by_column: &[f32; NOISE_LANES],
    ) -> ExposedBlock {
        let (mut means, mut deviations) = ([0; NOISE_LANES], [0; NOISE_LANES]);
        for lane in 0..NOISE_LANES {
            let cover = least(lit[lane], self.most_cover);
            let light = 1.0 - (lost_by_column[lane] + self.lost_by_row);
            let light = if light > 0.0 { light } else { 0.0 };
            let gray = light * (self.background + self.contrast * cover);
            let gray = if gray > 0.0 { gray } else { 0.0 };
            let deviation = (self.read_variance + self.shot_variance * gray).sqrt();
            // The additional 0.5 units compensate the mean truncation of the noise.
            means[lane] = whole(f32::from(PARTS) * (least(gray, 255.0) + 0.5) + 0.5);
            deviations[lane] = whole(least(DEVIATION_UNIT * deviation, f32::from(i16::MAX)));
        }
        ExposedBlock { means, deviations }
    }
}

/// Minimum of two numbers, compiled to a single instruction.
#[inline(always)]
fn least(one: f32, other: f32) -> f32 {
    if one > other { other } else { one }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A block of pixels of one gray level, with noise of standard deviation `deviation`.
    fn block(gray: f32, deviation: f32) -> ExposedBlock {
        let exposure = Exposure {
            background: gray,
            contrast: 0.0,
            most_cover: 1.0,
            read_variance: deviation * deviation,
            shot_variance: 0.0,
            lost_by_row: 0.0,
        };
        exposure.expose(&[0.0; NOISE_LANES], &[0.0; NOISE_LANES])
    }

    #[test]
    fn gray_values_are_rounded_and_clipped() {
        for (gray, expected) in [
            (-3.0, 0),
            (0.4, 0),
            (0.6, 1),
            (99.4, 99),
            (254.6, 255),
            (400.0, 255),
        ] {
            let grays = block(gray, 0.0).noisy(&[510; NOISE_LANES]);
            assert_eq!(grays, [expected; NOISE_LANES], "{gray}");
        }
        assert_eq!(
            block(f32::NAN, 0.0).noisy(&[0; NOISE_LANES]),
            [0; NOISE_LANES]
        );
        // Noise beyond the range of a pixel is clipped.
        for (gray, sample, expected) in [(1.0, -510, 0), (254.0, 510, 255)] {
            let grays = block(gray, 36.0).noisy(&[sample; NOISE_LANES]);
            assert_eq!(grays, [expected; NOISE_LANES], "{gray}");
        }
    }

    #[test]
    fn integer_noise_matches_floating_point() {
        for (gray, deviation) in [(20.0, 1.5), (127.3, 2.2), (190.0, 1.0), (100.0, 36.0)] {
            let block = block(gray, deviation);
            for sample in -510..=510_i16 {
                let exact = gray + deviation * f32::from(sample) / BYTE_SUM_DEVIATION;
                let [got, ..] = block.noisy(&[sample; NOISE_LANES]);
                // Half a level due to rounding, one unit due to rounding of mean and noise, and half a unit of the
                // deviation times the largest sample.
                let bound = 0.5 + 1.0 / f32::from(PARTS) + 0.5 / DEVIATION_UNIT * 3.46;
                let off = (f32::from(got) - exact.clamp(0.0, 255.0)).abs();
                assert!(
                    off <= bound,
                    "{gray}, {deviation}, {sample}: {got} for {exact}"
                );
            }
        }
    }
}
