//! From the light of a row's pixels to their grey levels with noise.

use super::light::Light;
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

    /// Grey levels without noise.
    #[inline(always)]
    fn mean(
        &self,
        lit: &[f32; NOISE_LANES],
        lost_by_column: &[f32; NOISE_LANES],
    ) -> [f32; NOISE_LANES] {
        let mut grays = [0.0; NOISE_LANES];
        for lane in 0..NOISE_LANES {
            let cover = if lit[lane] > self.most_cover {
                self.most_cover
            } else {
                lit[lane]
            };
            let light = 1.0 - (lost_by_column[lane] + self.lost_by_row);
            let light = if light > 0.0 { light } else { 0.0 };
            let gray = light * (self.background + self.contrast * cover);
            grays[lane] = if gray > 0.0 { gray } else { 0.0 };
        }
        grays
    }

    /// Grey levels of these means.
    #[inline(always)]
    fn noisy(&self, means: &[f32; NOISE_LANES], noise: &[f32; NOISE_LANES]) -> [u8; NOISE_LANES] {
        let mut grays = [0; NOISE_LANES];
        for lane in 0..NOISE_LANES {
            let mean = means[lane];
            let deviation = (self.read_variance + self.shot_variance * mean).sqrt();
            grays[lane] = quantised(mean + deviation * noise[lane]);
        }
        grays
    }
}

/// Grey levels without noise, block by block and row by row, where no element bears anything; where there are markers, without them.
pub(crate) fn grays_at_rest(model: &OpticsModel) -> Vec<[f32; NOISE_LANES]> {
    let (lost_by_column, _) = model.light_lost_by_column.as_chunks::<NOISE_LANES>();
    let mut grays = Vec::with_capacity(model.projection.height() * lost_by_column.len());
    let mut lit = vec![0.0; model.padded_width()];
    for row in 0..model.projection.height() {
        lit.fill(0.0);
        for light in (0..model.at_rest.len()).map(Light::AtRest) {
            if light.rows(model).contains(&row) {
                light.light_row(model, row, &mut lit);
            }
        }
        let exposure = Exposure::new(model, row);
        let (lit, _) = lit.as_chunks::<NOISE_LANES>();
        let blocks = lit.iter().zip(lost_by_column);
        grays.extend(blocks.map(|(lit, lost)| exposure.mean(lit, lost)));
    }
    grays
}

/// A row's light, and in which of its blocks it is another one than at rest.
pub(super) struct LitRow<'a> {
    pub lit: &'a [f32],
    pub changed: &'a [bool],
}

/// Turns the light of a row of the picture into grey levels with noise, where the model draws any.
#[inline(always)]
pub(super) fn expose(
    model: &OpticsModel,
    row: usize,
    LitRow { lit, changed }: LitRow,
    noise: &mut NoiseLanes,
    pixels: &mut [u8],
) {
    let exposure = Exposure::new(model, row);
    let (lit, _) = lit.as_chunks::<NOISE_LANES>();
    let (lost_by_column, _) = model.light_lost_by_column.as_chunks::<NOISE_LANES>();
    let first = row * lit.len();
    for drawn in model.drawn.in_row(row) {
        noise.skip_to(first + drawn.start);
        let columns = drawn.start * NOISE_LANES..pixels.len().min(drawn.end * NOISE_LANES);
        let (Some(pixels), Some(lit), Some(changed), Some(lost_by_column), Some(at_rest)) = (
            pixels.get_mut(columns),
            lit.get(drawn.clone()),
            changed.get(drawn.clone()),
            lost_by_column.get(drawn.clone()),
            model
                .grays_at_rest
                .get(first + drawn.start..first + drawn.end),
        ) else {
            return;
        };
        let lit = lit.iter().zip(changed).zip(lost_by_column).zip(at_rest);
        let mut means = lit.map(|(((lit, changed), lost), at_rest)| match changed {
            true => exposure.mean(lit, lost),
            false => *at_rest,
        });
        let (pixels, rest) = pixels.as_chunks_mut::<NOISE_LANES>();
        for (pixels, means) in pixels.iter_mut().zip(&mut means) {
            *pixels = exposure.noisy(&means, &noise.sample());
        }
        if let (false, Some(means)) = (rest.is_empty(), means.next()) {
            let grays = exposure.noisy(&means, &noise.sample());
            rest.copy_from_slice(&grays[..rest.len()]);
        }
    }
}
