//! The picture of a simulated fingertip: spots or markers on a dome, as a noisy camera sees them.

use super::{
    camera_noise::{NOISE_LANES, NoiseLanes, quantised},
    optics_config::OpticsError,
    optics_model::{OpticsModel, Spot},
};
use feeler::sensor::frame::Picture;
use glam::{DVec3, Vec3};
use multiversion::multiversion;
use rand_pcg::Pcg64;
use std::ops::Range;

/// Rows that are drawn at a time: as many as stay in the first cache.
const BAND: usize = 8;

/// What drawing a picture needs room for.
#[derive(Debug, Clone)]
pub struct OpticsScratch {
    /// The picture's spots.
    spots: Vec<SeenSpot>,
    /// How much of each pixel of a band is lit by spots, 0 between two bands; rows are padded to
    /// whole noise lanes.
    lit: Vec<f32>,
}

impl OpticsScratch {
    /// Room for drawing one picture of `model` at a time.
    pub fn new(model: &OpticsModel) -> Self {
        Self {
            spots: Vec::with_capacity(model.spot_count()),
            lit: vec![0.0; BAND * model.padded_width()],
        }
    }
}

/// Draws the picture of a fingertip with `forces` on its elements, N, each in its frame `E_i`.
///
/// The same model, forces and state of `rng` give the same picture, bit for bit.
///
/// # Errors
/// When `forces` or `picture` has another size than the model.
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
    // Nothing is done here unless the scratch was made for another model.
    scratch.lit.resize(BAND * model.padded_width(), 0.0);
    scratch.spots.clear();
    match &model.markers {
        Some(markers) => {
            let seen = |(element, spot)| SeenSpot::new(model, element, &spot);
            scratch.spots.extend(markers.spots(forces).filter_map(seen));
        }
        None => {
            for (element, &force) in forces.iter().enumerate() {
                let seen = |spot| SeenSpot::new(model, element, &spot);
                let spots = model.spots(force).into_iter();
                scratch.spots.extend(spots.filter_map(seen));
            }
        }
    }
    let noise = NoiseLanes::new(rng);
    draw(
        model,
        &scratch.spots,
        &mut scratch.lit,
        noise,
        &mut picture.pixels,
    );
    Ok(())
}

/// Draws band by band with the widest instructions that the processor has. They change no bit of the
/// picture: every operation is a single one on integers or IEEE numbers, in the same order.
#[multiversion(targets("x86_64+avx512f+avx512bw+avx512dq+avx512vl+avx2", "x86_64+avx2"))]
fn draw(
    model: &OpticsModel,
    spots: &[SeenSpot],
    lit: &mut [f32],
    mut noise: NoiseLanes,
    pixels: &mut [u8],
) {
    let (width, padded) = (model.projection.width(), model.padded_width());
    for (band, pixels) in pixels.chunks_mut(BAND * width).enumerate() {
        let rows = band * BAND..(band + 1) * BAND;
        for spot in spots {
            let own = spot.rows.start.max(rows.start)..spot.rows.end.min(rows.end);
            for row in own {
                let lit = &mut lit[(row - rows.start) * padded..];
                light_row(model, spot, row, lit);
            }
        }
        for (row, pixels) in rows.zip(pixels.chunks_mut(width)) {
            let start = (row % BAND) * padded;
            expose(
                model,
                row,
                &mut lit[start..start + padded],
                &mut noise,
                pixels,
            );
        }
    }
}

/// A spot as the camera sees it: a disc on the dome whose edge falls off linearly over twice the
/// blur. Its height is such that the light of the disc, the area of the contact, is kept however
/// small it is.
#[derive(Debug, Clone)]
struct SeenSpot {
    /// m, in `T`.
    centre: Vec3,
    profile: SpotProfile,
    rows: Range<usize>,
    columns: Range<usize>,
}

impl SeenSpot {
    /// The spot of an element; none where the cone does not touch or the camera does not see it.
    fn new(model: &OpticsModel, element: usize, spot: &Spot) -> Option<Self> {
        if spot.radius <= 0.0 {
            return None;
        }
        let projection = &model.projection;
        let (largest_scale, mean_scale) = model.scales[element];
        let blur = model.config.blur_px / mean_scale;
        let reach = spot.radius + blur;
        let point = projection.lift(spot.centre, &model.layout.elements[element])?;
        let pixel = projection.project(point)?;
        let half_box = reach * largest_scale + 1.0;
        // Casts to usize saturate at 0, so that a box beyond the picture is empty.
        let first = (pixel - half_box).floor();
        let last = (pixel + half_box).ceil() + 1.0;
        let (width, height) = (projection.width(), projection.height());
        Some(Self {
            centre: point.as_vec3(),
            profile: SpotProfile::new(spot.radius, blur, spot.contrast),
            rows: (first.y as usize).min(height)..(last.y as usize).min(height),
            columns: (first.x as usize).min(width)..(last.x as usize).min(width),
        })
    }
}

/// Adds the light of one spot in one row.
#[inline(always)]
fn light_row(model: &OpticsModel, spot: &SeenSpot, row: usize, lit: &mut [f32]) {
    let width = model.projection.width();
    let Range { start, end } = spot.columns;
    let span = row * width + start..row * width + end;
    let [x, y, z] = &model.dome_points;
    let (Some(lit), Some(x), Some(y), Some(z)) = (
        lit.get_mut(start..end),
        x.get(span.clone()),
        y.get(span.clone()),
        z.get(span),
    ) else {
        return;
    };
    let centre = spot.centre;
    for (((lit, x), y), z) in lit.iter_mut().zip(x).zip(y).zip(z) {
        let (dx, dy, dz) = (x - centre.x, y - centre.y, z - centre.z);
        *lit += spot.profile.at((dx * dx + dy * dy + dz * dz).sqrt());
    }
}

/// Brightness of a spot over the distance from its centre.
#[derive(Debug, Clone, Copy)]
struct SpotProfile {
    reach: f32,
    slope: f32,
    height: f32,
}

impl SpotProfile {
    /// For a spot of `radius` whose edge is blurred by `blur` to both sides, m, `contrast` times as bright as others.
    fn new(radius: f64, blur: f64, contrast: f64) -> Self {
        // Light of the unscaled profile over pi: a cone with its top cut off, or a whole cone.
        let light = if radius >= blur {
            radius * radius + blur * blur / 3.0
        } else {
            (radius + blur).powi(3) / (6.0 * blur)
        };
        let height = radius * radius * contrast / light;
        Self {
            reach: (radius + blur) as f32,
            slope: (height / (2.0 * blur)) as f32,
            height: height as f32,
        }
    }

    #[inline(always)]
    fn at(&self, distance: f32) -> f32 {
        let edge = (self.reach - distance) * self.slope;
        let edge = if edge > 0.0 { edge } else { 0.0 };
        if edge < self.height {
            edge
        } else {
            self.height
        }
    }
}

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

/// Turns a row's light into grey levels with noise, and leaves it dark for the next band.
#[inline(always)]
fn expose(
    model: &OpticsModel,
    row: usize,
    lit: &mut [f32],
    noise: &mut NoiseLanes,
    pixels: &mut [u8],
) {
    let exposure = Exposure::new(model, row);
    let (pixels, rest) = pixels.as_chunks_mut::<NOISE_LANES>();
    let (lit, _) = lit.as_chunks_mut::<NOISE_LANES>();
    let (lost_by_column, _) = model.light_lost_by_column.as_chunks::<NOISE_LANES>();
    let whole = pixels.len();
    for ((pixels, lit), lost) in pixels.iter_mut().zip(&mut *lit).zip(lost_by_column) {
        *pixels = exposure.grays(lit, lost, &noise.sample());
        *lit = [0.0; NOISE_LANES];
    }
    if let (false, Some(lit), Some(lost)) = (
        rest.is_empty(),
        lit.get_mut(whole),
        lost_by_column.get(whole),
    ) {
        let grays = exposure.grays(lit, lost, &noise.sample());
        rest.copy_from_slice(&grays[..rest.len()]);
        *lit = [0.0; NOISE_LANES];
    }
}
