//! Renders images of a simulated fingertip: spots or markers on a dome, with camera noise.

pub(crate) mod exposed_block;
mod exposure;
pub(crate) mod light;
pub(crate) mod ranges;
pub(crate) mod rest_light;
pub(crate) mod seen_spot;

use self::{
    exposure::{LitRow, expose},
    light::Light,
    ranges::{hull, meet},
    seen_spot::ProjectedSpot,
};
use super::camera_noise::{NOISE_LANES, PictureNoise};
use super::error::OpticsError;
use super::model::OpticsModel;
use feeler::sensor::image::Picture;
use glam::DVec3;
use multiversion::multiversion;
use rand_pcg::Pcg64;

/// Number of rows that are rendered at a time; their data fits into the L1 cache.
const BAND: usize = 8;

/// Buffers for rendering, which avoid allocation.
#[derive(Debug, Clone)]
pub struct OpticsScratch {
    /// Light sources of the image.
    lights: Vec<Light>,
    /// Indices of the light sources in each band, in the order of summation.
    by_band: Vec<Vec<usize>>,
    /// Coverage of each pixel of a band by spots, 0 between two bands. Rows are padded to whole noise blocks.
    lit: Vec<f32>,
    /// Noise blocks of a band whose light differs from that at rest.
    changed: Vec<bool>,
}

impl OpticsScratch {
    /// Allocates the buffers for images of `model`.
    pub fn new(model: &OpticsModel) -> Self {
        let spots = model.spot_count();
        let bands = model.projection.height().div_ceil(BAND);
        Self {
            lights: Vec::with_capacity(2 * spots),
            by_band: (0..bands).map(|_| Vec::with_capacity(2 * spots)).collect(),
            lit: vec![0.0; BAND * model.padded_width()],
            changed: vec![false; BAND * model.padded_width() / NOISE_LANES],
        }
    }

    /// Determines the light sources of an image with `forces`, and sorts them into bands.
    fn see(&mut self, model: &OpticsModel, forces: &[DVec3]) {
        // Has no effect unless the buffers were created for another model.
        self.lit.resize(BAND * model.padded_width(), 0.0);
        self.changed.resize(self.lit.len() / NOISE_LANES, false);
        let bands = model.projection.height().div_ceil(BAND);
        self.by_band.resize_with(bands, Vec::new);
        self.by_band.iter_mut().for_each(Vec::clear);
        self.lights.clear();
        let seen = |element, spot| ProjectedSpot::new(model, element, &spot).map(Light::Spot);
        if let Some(markers) = &model.markers {
            let spots = markers.spots(forces);
            let lights = spots.filter_map(|(element, spot)| seen(element, spot));
            self.lights.extend(lights);
        } else {
            for (element, &force) in forces.iter().enumerate() {
                if force == DVec3::ZERO {
                    self.lights.push(Light::AtRest(element));
                } else {
                    self.lights.push(Light::NotAtRest(element));
                    let spots = model.spots(force).into_iter();
                    let lights = spots.filter_map(|spot| seen(element, spot));
                    self.lights.extend(lights);
                }
            }
        }
        for (index, light) in self.lights.iter().enumerate() {
            let rows = light.rows(model);
            let bands = rows.start / BAND..rows.end.div_ceil(BAND);
            for band in self.by_band.get_mut(bands).unwrap_or_default() {
                band.push(index);
            }
        }
    }
}

/// Renders the image of a fingertip with `forces` on its elements (N), each in its frame `E_i`.
///
/// The same model, forces and state of `rng` give a bit-identical image.
///
/// # Errors
/// If the size of `forces` or `picture` differs from the model's.
pub fn render(
    model: &OpticsModel,
    scratch: &mut OpticsScratch,
    forces: &[DVec3],
    rng: &mut Pcg64,
    picture: &mut Picture,
) -> Result<(), OpticsError> {
    if forces.len() != model.layout.elements.len() {
        return Err(OpticsError::ElementCount {
            expected: model.layout.elements.len(),
            actual: forces.len(),
        });
    }
    let (width, height) = (model.projection.width(), model.projection.height());
    let pixels = picture.pixels.len();
    if (picture.width, picture.height, pixels) != (width, height, width * height) {
        return Err(OpticsError::PictureSize {
            expected_width: width,
            expected_height: height,
            width: picture.width,
            height: picture.height,
            pixels,
        });
    }
    scratch.see(model, forces);
    draw(model, scratch, &PictureNoise::new(rng), &mut picture.pixels);
    Ok(())
}

/// Renders band by band with the widest vector instructions of the processor. Results are bit-identical on all of them,
/// as every operation is a single one on integers or IEEE numbers, in the same order. Callees must be inlined: separate
/// functions would not be compiled for these instructions.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl+avx2", "x86_64+avx2"))]
fn draw(model: &OpticsModel, scratch: &mut OpticsScratch, noise: &PictureNoise, pixels: &mut [u8]) {
    let (width, padded) = (model.projection.width(), model.padded_width());
    let OpticsScratch {
        lights,
        by_band,
        lit,
        changed,
    } = scratch;
    let bands = pixels.chunks_mut(BAND * width).zip(by_band);
    for (band, (pixels, own)) in bands.enumerate() {
        let first = band * BAND;
        let own = || own.iter().filter_map(|&index| lights.get(index));
        let changes = own().filter_map(|light| light.changes(model)).reduce(hull);
        // Blocks without changes use the table of gray levels at rest.
        let wanted = changes.unwrap_or_default();
        let wanted =
            wanted.start / NOISE_LANES * NOISE_LANES..wanted.end.next_multiple_of(NOISE_LANES);
        let mut drawn = 0..0;
        for light in own().filter(|light| meet(&light.columns(model), &wanted)) {
            let (rows, columns) = (light.rows(model), light.columns(model));
            let blocks = columns.start / NOISE_LANES..columns.end.div_ceil(NOISE_LANES);
            let is_change = light.changes(model).is_some();
            for row in rows.start.max(first)..rows.end.min(first + BAND) {
                let start = (row - first) * padded;
                light.light_row(model, row, &mut lit[start..]);
                if is_change {
                    changed[start / NOISE_LANES..][blocks.clone()].fill(true);
                }
            }
            drawn = hull(drawn, columns);
        }
        let rows = lit.chunks(padded).zip(changed.chunks(padded / NOISE_LANES));
        for (row, (pixels, (lit, changed))) in pixels.chunks_mut(width).zip(rows).enumerate() {
            let lit = LitRow { lit, changed };
            expose(model, first + row, lit, noise, pixels);
        }
        if !drawn.is_empty() {
            lit.chunks_mut(padded)
                .for_each(|lit| lit[drawn.clone()].fill(0.0));
            changed.fill(false);
        }
    }
}
