//! Converts the light of a row of pixels to gray levels with noise.

use super::exposed_block::{ExposedBlock, Exposure};
use crate::optics::camera_noise::{NOISE_LANES, PictureNoise};
use crate::optics::model::OpticsModel;

/// Light of a row, and flags of the blocks that differ from the image at rest.
pub(super) struct LitRow<'a> {
    pub lit: &'a [f32],
    pub changed: &'a [bool],
}

/// Converts the light of a row to gray levels with noise, in the blocks that the model renders.
#[inline(always)]
pub(super) fn expose(
    model: &OpticsModel,
    row: usize,
    LitRow { lit, changed }: LitRow,
    noise: &PictureNoise,
    pixels: &mut [u8],
) {
    let exposure = Exposure::new(&model.config, model.light_lost_by_row[row]);
    let (lit, _) = lit.as_chunks::<NOISE_LANES>();
    let (lost_by_column, _) = model.light_lost_by_column.as_chunks::<NOISE_LANES>();
    let first = row * lit.len();
    for drawn in model.drawn.in_row(row) {
        let in_picture = first + drawn.start..first + drawn.end;
        let columns = drawn.start * NOISE_LANES..pixels.len().min(drawn.end * NOISE_LANES);
        let (Some(pixels), Some(lit), Some(changed), Some(lost_by_column), Some(at_rest)) = (
            pixels.get_mut(columns),
            lit.get(drawn.clone()),
            changed.get(drawn.clone()),
            lost_by_column.get(drawn),
            model.exposed_at_rest.get(in_picture.clone()),
        ) else {
            return;
        };
        let run = Run {
            exposure: &exposure,
            lit,
            changed,
            lost_by_column,
            at_rest,
            noise,
            first: in_picture.start,
        };
        let (pixels, rest) = pixels.as_chunks_mut::<NOISE_LANES>();
        for (at, pixels) in pixels.iter_mut().enumerate() {
            *pixels = run.grays(at);
        }
        if !rest.is_empty() {
            rest.copy_from_slice(&run.grays(pixels.len())[..rest.len()]);
        }
    }
}

/// A contiguous run of blocks of a row.
struct Run<'a> {
    exposure: &'a Exposure,
    lit: &'a [[f32; NOISE_LANES]],
    changed: &'a [bool],
    lost_by_column: &'a [[f32; NOISE_LANES]],
    at_rest: &'a [ExposedBlock],
    noise: &'a PictureNoise,
    /// Index of the first block in the image.
    first: usize,
}

impl Run<'_> {
    /// Gray levels of a block. (A closure would be a separate function, compiled without wide vector instructions.)
    #[inline(always)]
    fn grays(&self, at: usize) -> [u8; NOISE_LANES] {
        let anew;
        let exposed = if self.changed[at] {
            anew = self
                .exposure
                .expose(&self.lit[at], &self.lost_by_column[at]);
            &anew
        } else {
            &self.at_rest[at]
        };
        exposed.noisy(&self.noise.of_block(self.first + at))
    }
}
