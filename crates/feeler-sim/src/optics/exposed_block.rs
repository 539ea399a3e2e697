//! Grey levels and their noise, sixteen pixels at a time.

use crate::{
    camera_noise::{BYTE_SUM_DEVIATION, NOISE_LANES},
    optics_model::OpticsModel,
};

/// A block's grey levels and their noise in whole numbers, of which a vector of 256 bits holds all sixteen.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ExposedBlock {
    /// Means in parts of a grey level, [`PARTS`] to one, and half a level: what is cut off later is rounded by it.
    means: [i16; NOISE_LANES],
    /// Standard deviations, [`DEVIATION_UNIT`] to a grey level.
    deviations: [i16; NOISE_LANES],
}

/// Parts of a grey level.
const PARTS: i16 = 1 << PART_BITS;
const PART_BITS: u32 = 7;
/// By how many bits samples are shifted to fill 16 bits.
const SAMPLE_SHIFT: u32 = 6;
/// Of a standard deviation, so that its product with a shifted sample is 2^16 times as many parts of a grey level. 36 levels
/// fit into 16 bits.
const DEVIATION_UNIT: f32 = PARTS as f32 / BYTE_SUM_DEVIATION * (1 << (16 - SAMPLE_SHIFT)) as f32;

impl ExposedBlock {
    /// Grey levels with these samples of noise.
    #[inline(always)]
    pub fn noisy(&self, samples: &[i16; NOISE_LANES]) -> [u8; NOISE_LANES] {
        let mut grays = [0; NOISE_LANES];
        for lane in 0..NOISE_LANES {
            let sample = samples[lane] << SAMPLE_SHIFT;
            // The upper half of the product, which is one instruction.
            let noise = (i32::from(sample) * i32::from(self.deviations[lane])) >> 16;
            let gray = self.means[lane].saturating_add(noise as i16) >> PART_BITS;
            grays[lane] = gray.clamp(0, 255) as u8;
        }
        grays
    }
}

/// `value`, from 0 to 32767, as the nearest whole number; 0 where it is not a number.
#[inline(always)]
fn whole(value: f32) -> i16 {
    // Adding 2^23 leaves the nearest integer in the lowest bits.
    (value + 8_388_608.0).to_bits() as i16
}

/// What a pixel's grey level is made of.
pub(super) struct Exposure {
    background: f32,
    contrast: f32,
    most_cover: f32,
    read_variance: f32,
    shot_variance: f32,
    lost_by_row: f32,
}

impl Exposure {
    /// That of the pixels of a row.
    #[inline(always)]
    pub fn new(model: &OpticsModel, row: usize) -> Self {
        let config = &model.config;
        Self {
            background: config.background_gray as f32,
            contrast: (config.spot_gray - config.background_gray) as f32,
            // Contacts that overlap are not brighter for it; markers differ in brightness.
            most_cover: match model.markers {
                Some(_) => f32::INFINITY,
                None => 1.0,
            },
            read_variance: config.read_noise.powi(2) as f32,
            shot_variance: config.shot_noise.powi(2) as f32,
            lost_by_row: model.light_lost_by_row[row],
        }
    }

    /// A block of pixels that are lit so.
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
            // And half a part, as much as is cut off the noise on average.
            means[lane] = whole(f32::from(PARTS) * (least(gray, 255.0) + 0.5) + 0.5);
            deviations[lane] = whole(least(DEVIATION_UNIT * deviation, f32::from(i16::MAX)));
        }
        ExposedBlock { means, deviations }
    }
}

/// The smaller of two numbers, in one instruction.
#[inline(always)]
fn least(one: f32, other: f32) -> f32 {
    if one > other { other } else { one }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A block of pixels of one grey level with noise of that standard deviation.
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
        // Noise reaches beyond what a pixel can tell.
        for (gray, sample, expected) in [(1.0, -510, 0), (254.0, 510, 255)] {
            let grays = block(gray, 36.0).noisy(&[sample; NOISE_LANES]);
            assert_eq!(grays, [expected; NOISE_LANES], "{gray}");
        }
    }

    #[test]
    fn noise_in_whole_numbers_is_that_in_numbers_with_a_point() {
        for (gray, deviation) in [(20.0, 1.5), (127.3, 2.2), (190.0, 1.0), (100.0, 36.0)] {
            let block = block(gray, deviation);
            for sample in -510..=510_i16 {
                let exact = gray + deviation * f32::from(sample) / BYTE_SUM_DEVIATION;
                let [got, ..] = block.noisy(&[sample; NOISE_LANES]);
                // Half a level by rounding; mean and noise are each rounded to parts of a level, and a deviation by half
                // a unit makes as much of the largest sample.
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
