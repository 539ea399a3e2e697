//! The picture of a simulated fingertip: bright spots on a dim dome, as a noisy camera sees them.

use super::{
    camera_noise::{NOISE_LANES, NoiseLanes, quantised},
    optics_config::OpticsError,
    optics_model::{OpticsModel, Spot},
};
use crate::sensor::frame::Picture;
use glam::DVec3;
use rand_pcg::Pcg64;

/// What drawing a picture needs room for.
#[derive(Debug, Clone)]
pub struct OpticsScratch {
    /// How much of each pixel is lit by spots, 0 between two pictures; padded to whole noise lanes.
    lit: Vec<f32>,
}

impl OpticsScratch {
    /// Room for drawing one picture of `model` at a time.
    pub fn new(model: &OpticsModel) -> Self {
        Self {
            lit: vec![0.0; model.vignetting.len()],
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
    scratch.lit.resize(model.vignetting.len(), 0.0);
    for (element, &force) in forces.iter().enumerate() {
        for spot in model.spots(force) {
            light_spot(model, element, &spot, &mut scratch.lit);
        }
    }
    expose(model, &mut scratch.lit, rng, &mut picture.pixels);
    Ok(())
}

/// Adds one spot to the light.
///
/// The spot is a disc on the dome whose edge falls off linearly over twice the blur. Its height is
/// such that the light of the disc, the area of the contact, is kept however small it is.
fn light_spot(model: &OpticsModel, element: usize, spot: &Spot, lit: &mut [f32]) {
    if spot.radius <= 0.0 {
        return;
    }
    let projection = &model.projection;
    let (largest_scale, mean_scale) = model.scales[element];
    let blur = model.config.blur_px / mean_scale;
    let reach = spot.radius + blur;
    let seen = projection
        .lift(spot.centre, &model.layout.elements[element])
        .and_then(|point| Some((point, projection.project(point)?)));
    let Some((point, pixel)) = seen else {
        return;
    };
    let half_box = reach * largest_scale + 1.0;
    // Casts to usize saturate at 0, so that a box beyond the picture is empty.
    let first = (pixel - half_box).floor();
    let last = (pixel + half_box).ceil() + 1.0;
    let (width, height) = (projection.width(), projection.height());
    let columns = (first.x as usize).min(width)..(last.x as usize).min(width);
    let rows = (first.y as usize).min(height)..(last.y as usize).min(height);
    let profile = SpotProfile::new(spot.radius, blur);
    let centre = point.as_vec3();
    for row in rows {
        let span = row * width + columns.start..row * width + columns.end;
        let [x, y, z] = &model.dome_points;
        let (Some(lit), Some(x), Some(y), Some(z)) = (
            lit.get_mut(span.clone()),
            x.get(span.clone()),
            y.get(span.clone()),
            z.get(span),
        ) else {
            continue;
        };
        for (((lit, x), y), z) in lit.iter_mut().zip(x).zip(y).zip(z) {
            let (dx, dy, dz) = (x - centre.x, y - centre.y, z - centre.z);
            *lit += profile.at((dx * dx + dy * dy + dz * dz).sqrt());
        }
    }
}

/// Brightness of a spot over the distance from its centre.
struct SpotProfile {
    reach: f32,
    slope: f32,
    height: f32,
}

impl SpotProfile {
    /// For a contact of `radius` whose edge is blurred by `blur` to both sides, m.
    fn new(radius: f64, blur: f64) -> Self {
        // Light of the unscaled profile over pi: a cone with its top cut off, or a whole cone.
        let light = if radius >= blur {
            radius * radius + blur * blur / 3.0
        } else {
            (radius + blur).powi(3) / (6.0 * blur)
        };
        let height = radius * radius / light;
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

/// Turns the light into grey levels with noise, and leaves it dark for the next picture.
fn expose(model: &OpticsModel, lit: &mut [f32], rng: &mut Pcg64, pixels: &mut [u8]) {
    let config = &model.config;
    let background = config.background_gray as f32;
    let contrast = (config.spot_gray - config.background_gray) as f32;
    let read_variance = config.read_noise.powi(2) as f32;
    let shot_variance = config.shot_noise.powi(2) as f32;
    let mut lanes = NoiseLanes::new(rng);
    let (lit, _) = lit.as_chunks_mut::<NOISE_LANES>();
    let (vignetting, _) = model.vignetting.as_chunks::<NOISE_LANES>();
    for ((pixels, lit), vignetting) in pixels.chunks_mut(NOISE_LANES).zip(lit).zip(vignetting) {
        let noise = lanes.sample();
        let mut grays = [0; NOISE_LANES];
        for lane in 0..NOISE_LANES {
            let cover = if lit[lane] < 1.0 { lit[lane] } else { 1.0 };
            let gray = vignetting[lane] * (background + contrast * cover);
            let deviation = (read_variance + shot_variance * gray).sqrt();
            grays[lane] = quantised(gray + deviation * noise[lane]);
        }
        *lit = [0.0; NOISE_LANES];
        pixels.copy_from_slice(&grays[..pixels.len()]);
    }
}
