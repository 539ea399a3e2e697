//! What a simulated fingertip's camera sees: bright spots where conical feelers press on the dome.
//!
//! An element is a column on eight cones at radius `r_c` around its axis (paper, section II), each
//! preloaded with `f_0`. A force on the feeler's tip, in the convention of
//! [`TactileFrame`](crate::sensor::reading::TactileFrame), loads cone k at `(x_k, y_k)` with
//!
//! ```text
//! f_k = f_0 + F_z / 8 + (F_x x_k + F_y y_k) h / sum x²,   not less than 0.
//! ```
//!
//! A shear force along +x acts at the height `h` over the cones: it tilts the column so that the
//! cones on the +x side carry more, and it carries the whole foot along by `F_x / k_shift`. Both move
//! the centroid of the bright spots in the direction of the shear force, by
//! `F_x (h / (8 f_0 + F_z) + 1 / k_shift)` as long as no cone lifts off.
//!
//! The contact of a cone is a disc with `f = 2 E* tan(a) r² / pi`, `E* = E / (1 - nu²)` (Sneddon's
//! elastic cone), `a` between flank and dome: its area grows linearly with the load.

use super::{
    camera_noise::{NOISE_LANES, NoiseLanes, quantised},
    optics_config::{OpticsConfig, OpticsError},
};
use crate::sensor::{dome::DomeProjection, frame::Picture, layout::ElementLayout};
use glam::{DVec2, DVec3};
use rand_pcg::Pcg64;
use std::f64::consts::{PI, TAU};

/// Conical feelers under one columnar feeler (paper, section II).
pub const CONES: usize = 8;

/// One of an element's bright spots.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// Load of the cone, N.
    pub load: f64,
    /// Centre in x, y of the element's frame `E_i`, m.
    pub centre: DVec2,
    /// Radius of the contact, m.
    pub radius: f64,
}

/// What the camera's picture consists of and does not change.
#[derive(Debug, Clone)]
pub struct OpticsModel {
    config: OpticsConfig,
    layout: ElementLayout,
    projection: DomeProjection,
    cones: [DVec2; CONES],
    /// Area of a contact per load, m²/N.
    area_per_load: f64,
    /// Pixels per metre of the dome at each element: in the direction in which it is largest, and as
    /// the root of the area factor.
    scales: Vec<(f64, f64)>,
    /// x, y, z of the dome's point at each pixel, m, in `T`; far away where there is none.
    dome_points: [Vec<f32>; 3],
    /// Part of the light that reaches each pixel; padded to whole noise lanes.
    vignetting: Vec<f32>,
}

/// What drawing a picture needs room for.
#[derive(Debug, Clone)]
pub struct OpticsScratch {
    /// How much of each pixel is lit by spots, 0 between two pictures; padded to whole noise lanes.
    lit: Vec<f32>,
}

impl OpticsModel {
    /// The optics of `config` for elements at `layout` seen through `projection`.
    ///
    /// # Errors
    /// When a value is out of its range, or the camera does not see an element.
    pub fn new(
        config: &OpticsConfig,
        layout: &ElementLayout,
        projection: &DomeProjection,
    ) -> Result<Self, OpticsError> {
        config.check()?;
        let modulus = config.youngs_modulus / (1.0 - config.poisson_ratio.powi(2));
        let flank = config.cone_flank_deg.to_radians();
        // Half a step off the element's axes: so turned, the spots of neighbours on a ring are
        // farthest apart.
        let cones = std::array::from_fn(|k| {
            config.cone_circle_radius * DVec2::from_angle(TAU * (k as f64 + 0.5) / CONES as f64)
        });
        let scales = (0..layout.elements.len())
            .map(|element| {
                pixel_scales(layout, projection, element, config.cone_circle_radius)
                    .ok_or(OpticsError::Unseen { element })
            })
            .collect::<Result<_, _>>()?;
        Ok(Self {
            config: config.clone(),
            layout: layout.clone(),
            projection: projection.clone(),
            cones,
            area_per_load: PI * PI / (2.0 * modulus * flank.tan()),
            scales,
            dome_points: dome_points(projection),
            vignetting: vignetting(projection, config.vignetting),
        })
    }

    /// Room for drawing one picture at a time.
    pub fn scratch(&self) -> OpticsScratch {
        OpticsScratch {
            lit: vec![0.0; self.vignetting.len()],
        }
    }

    /// The spots of an element under `force`, N, in its frame `E_i`.
    pub fn spots(&self, force: DVec3) -> [Spot; CONES] {
        let config = &self.config;
        let sum_of_squares = 0.5 * CONES as f64 * config.cone_circle_radius.powi(2);
        let shift =
            (force.truncate() / config.shear_stiffness).clamp_length_max(config.cone_base_radius);
        self.cones.map(|cone| {
            let tilt = force.truncate().dot(cone) * config.lever_height / sum_of_squares;
            let load = (config.preload + force.z / CONES as f64 + tilt).max(0.0);
            Spot {
                load,
                centre: cone + shift,
                radius: (self.area_per_load * load / PI)
                    .sqrt()
                    .min(config.cone_base_radius),
            }
        })
    }

    /// Area of a cone's contact per load, m²/N.
    pub fn area_per_load(&self) -> f64 {
        self.area_per_load
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
    // Casts to usize saturate, so that a box beyond the picture is empty.
    let first = (pixel - half_box).floor();
    let last = (pixel + half_box).ceil() + 1.0;
    let columns = first.x as usize..(last.x as usize).min(projection.width());
    let rows = first.y as usize..(last.y as usize).min(projection.height());
    let profile = SpotProfile::new(spot.radius, blur);
    let centre = point.as_vec3();
    for row in rows {
        let span = row * projection.width() + columns.start..row * projection.width() + columns.end;
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

/// Largest and mean number of pixels per metre of the dome within `radius` of an element's axis.
fn pixel_scales(
    layout: &ElementLayout,
    projection: &DomeProjection,
    element: usize,
    radius: f64,
) -> Option<(f64, f64)> {
    let own = &layout.elements[element];
    let step = 1e-5;
    let mut largest = 0.0_f64;
    for k in 0..CONES {
        let place = radius * DVec2::from_angle(TAU * k as f64 / CONES as f64);
        let seen = |offset| projection.project(projection.lift(place + offset, own)?);
        let along_x = (seen(DVec2::X * step)? - seen(DVec2::ZERO)?) / step;
        let along_y = (seen(DVec2::Y * step)? - seen(DVec2::ZERO)?) / step;
        // Frobenius norm of the local map: no direction is stretched more.
        largest = largest.max((along_x.length_squared() + along_y.length_squared()).sqrt());
    }
    let area = projection
        .dewarp(projection.project(layout.tip(element))?, own)?
        .area;
    Some((largest, area.sqrt().recip()))
}

/// The dome's point at each pixel.
fn dome_points(projection: &DomeProjection) -> [Vec<f32>; 3] {
    let (width, height) = (projection.width(), projection.height());
    let mut points = [(); 3].map(|()| Vec::with_capacity(width * height));
    for row in 0..height {
        for column in 0..width {
            let pixel = DVec2::new(column as f64, row as f64);
            // A metre away from the dome, where no spot reaches.
            let point = projection.point_at(pixel).unwrap_or(DVec3::ONE);
            for (points, coordinate) in points.iter_mut().zip(point.to_array()) {
                points.push(coordinate as f32);
            }
        }
    }
    points
}

/// Part of the light that reaches each pixel, padded to whole noise lanes.
fn vignetting(projection: &DomeProjection, loss: f64) -> Vec<f32> {
    let (width, height) = (projection.width(), projection.height());
    let half_width = width as f64 / 2.0;
    let at = |index: usize| {
        let pixel = DVec2::new((index % width) as f64, (index / width) as f64);
        let distance = (pixel - projection.centre()).length() / half_width;
        (1.0 - loss * distance * distance).max(0.0) as f32
    };
    (0..(width * height).next_multiple_of(NOISE_LANES))
        .map(at)
        .collect()
}
