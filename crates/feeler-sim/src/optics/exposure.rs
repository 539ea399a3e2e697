//! From the light of a row's pixels to their grey levels with noise.

use crate::{
    camera_noise::{NOISE_LANES, NoiseLanes, quantised},
    optics_model::OpticsModel,
};

/// What a pixel's grey level is made of.
struct Exposure {
    background: f32,
    contrast: f32,
    most_cover: f32,
    read_variance: f32,
    shot_variance: f32,
    lost_by_row: f32,
}

impl Exposure {
    #[inline(always)]
    fn new(model: &OpticsModel, row: usize) -> Self {
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

    /// Grey levels with noise.
    #[inline(always)]
    fn grays(
        &self,
        lit: &[f32; NOISE_LANES],
        lost_by_column: &[f32; NOISE_LANES],
        noise: &[f32; NOISE_LANES],
    ) -> [u8; NOISE_LANES] {
        let mut grays = [0; NOISE_LANES];
        for lane in 0..NOISE_LANES {
            let cover = if lit[lane] > self.most_cover {
                self.most_cover
            } else {
                lit[lane]
            };
            let light = 1.0 - (lost_by_column[lane] + self.lost_by_row);
            let light = if light > 0.0 { light } else { 0.0 };
            let gray = light * (self.background + self.contrast * cover);
            let gray = if gray > 0.0 { gray } else { 0.0 };
            let deviation = (self.read_variance + self.shot_variance * gray).sqrt();
            grays[lane] = quantised(gray + deviation * noise[lane]);
        }
        grays
    }
}

/// Turns the light of a row of the picture into grey levels with noise, where the model draws any.
#[inline(always)]
pub(super) fn expose(
    model: &OpticsModel,
    row: usize,
    lit: &[f32],
    noise: &mut NoiseLanes,
    pixels: &mut [u8],
) {
    let exposure = Exposure::new(model, row);
    let (lit, _) = lit.as_chunks::<NOISE_LANES>();
    let (lost_by_column, _) = model.light_lost_by_column.as_chunks::<NOISE_LANES>();
    for drawn in model.drawn.in_row(row) {
        noise.skip_to(row * lit.len() + drawn.start);
        let columns = drawn.start * NOISE_LANES..pixels.len().min(drawn.end * NOISE_LANES);
        let (Some(pixels), Some(lit), Some(lost_by_column)) = (
            pixels.get_mut(columns),
            lit.get(drawn.clone()),
            lost_by_column.get(drawn),
        ) else {
            return;
        };
        let mut blocks = lit.iter().zip(lost_by_column);
        let (pixels, rest) = pixels.as_chunks_mut::<NOISE_LANES>();
        for (pixels, (lit, lost)) in pixels.iter_mut().zip(&mut blocks) {
            *pixels = exposure.grays(lit, lost, &noise.sample());
        }
        if let (false, Some((lit, lost))) = (rest.is_empty(), blocks.next()) {
            let grays = exposure.grays(lit, lost, &noise.sample());
            rest.copy_from_slice(&grays[..rest.len()]);
        }
    }
}
