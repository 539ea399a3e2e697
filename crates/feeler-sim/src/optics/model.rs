//! Contact of a simulated fingertip's conical feelers with the dome, and constant data for rendering.
//!
//! An element is a column on eight cones at radius `r_c` around its axis (paper, section II), each with a preload
//! `f_0`. A force on the feeler's tip, with the signs of a [`TactileFrame`](feeler::sensor::forces::TactileFrame),
//! loads cone k at `(x_k, y_k)` with
//!
//! ```text
//! f_k = f_0 + F_z / 8 + (F_x x_k + F_y y_k) h / sum x²,   at least 0.
//! ```
//!
//! A shear force along +x acts at the height `h` above the cones. It tilts the column, so that cones on the +x side
//! carry more, and shifts the foot by `F_x / k_shift`. Both displace the centroid of the bright spots in the direction
//! of the shear force, by `F_x (h / (8 f_0 + F_z) + 1 / k_shift)` while no cone lifts off.
//!
//! The contact of a cone is a disc with `f = 2 E* tan(a) r² / pi` and `E* = E / (1 - nu²)` (Sneddon's elastic cone),
//! where `a` is the angle between flank and dome. Its area is proportional to the load.
//!
//! Other fingertips have markers instead; see [`markers`](super::markers).

use super::camera_noise::NOISE_LANES;
use super::config::OpticsConfig;
use super::drawn_blocks::DrawnBlocks;
use super::error::OpticsError;
use super::markers::{MarkerConfig, MarkerModel};
use super::renderer::exposed_block::ExposedBlock;
use super::renderer::rest_light::RestLight;
use super::spot::Spot;
use feeler::math::direction_at;
use feeler::sensor::fingertip::{DomeProjection, ElementLayout};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Number of conical feelers under a columnar feeler (paper, section II).
pub const CONES: usize = 8;

/// Constant data for rendering the images of a fingertip.
#[derive(Debug, Clone)]
pub struct OpticsModel {
    pub(crate) config: OpticsConfig,
    pub(crate) layout: ElementLayout,
    pub(crate) projection: DomeProjection,
    cones: [DVec2; CONES],
    pub(crate) markers: Option<MarkerModel>,
    /// Contact area per load (m²/N).
    area_per_load: f64,
    /// Pixels per metre of the dome at each element: maximum over directions, and root of the area factor.
    pub(crate) scales: Vec<(f64, f64)>,
    /// Coordinates x, y and z in `T` of the dome's point at each pixel (m); far away for pixels without a point.
    pub(crate) dome_points: [Vec<f32>; 3],
    /// Relative loss of light of each column due to vignetting, padded to whole noise blocks. The loss of a pixel is
    /// the sum of those of its column and its row.
    pub(crate) light_lost_by_column: Vec<f32>,
    /// Relative loss of light of each row due to vignetting.
    pub(crate) light_lost_by_row: Vec<f32>,
    pub(crate) drawn: DrawnBlocks,
    /// Light of each unloaded element. Empty with markers, as they influence each other.
    pub(crate) at_rest: Vec<RestLight>,
    /// Blocks of the image of an unloaded fingertip without noise; with markers, of the dome alone.
    pub(crate) exposed_at_rest: Vec<ExposedBlock>,
}

impl OpticsModel {
    /// Like [`new`](Self::new), but without the light of an unloaded fingertip.
    pub(super) fn without_light_at_rest(
        config: &OpticsConfig,
        layout: &ElementLayout,
        projection: &DomeProjection,
    ) -> Result<Self, OpticsError> {
        config.check()?;
        let modulus = config.youngs_modulus / (1.0 - config.poisson_ratio.powi(2));
        let flank = config.cone_flank_deg.to_radians();
        // Offset by half a step from the element's axes, which maximizes the distance between spots of neighbours on a
        // ring.
        let cones = std::array::from_fn(|k| {
            config.cone_circle_radius * direction_at(TAU * (k as f64 + 0.5) / CONES as f64)
        });
        let markers = config.markers.as_ref();
        let about_axis = markers.map_or(config.cone_circle_radius, MarkerConfig::reach);
        let scales = (0..layout.elements.len())
            .map(|element| {
                pixel_scales(layout, projection, element, about_axis)
                    .ok_or(OpticsError::Unseen { element })
            })
            .collect::<Result<_, _>>()?;
        // Loss per squared distance from the centre (1/px²).
        let lost_per_square = config.vignetting / (projection.width() as f64 / 2.0).powi(2);
        Ok(Self {
            config: config.clone(),
            layout: layout.clone(),
            projection: projection.clone(),
            cones,
            markers: markers.map(|markers| MarkerModel::new(markers, layout, projection)),
            area_per_load: PI * PI / (2.0 * modulus * libm::tan(flank)),
            scales,
            dome_points: dome_points(projection),
            light_lost_by_column: light_lost(
                projection.width(),
                projection.centre().x,
                lost_per_square,
            ),
            light_lost_by_row: light_lost(
                projection.height(),
                projection.centre().y,
                lost_per_square,
            ),
            drawn: DrawnBlocks::all(projection.width(), projection.height()),
            at_rest: Vec::new(),
            exposed_at_rest: Vec::new(),
        })
    }

    /// Restricts rendering to the blocks that contain `pixels` (column, row). Those pixels are bit-identical to a full
    /// image; others are unspecified.
    #[must_use]
    pub fn drawing_only(self, pixels: impl Iterator<Item = (usize, usize)>) -> Self {
        let (width, height) = (self.projection.width(), self.projection.height());
        Self {
            drawn: DrawnBlocks::with_pixels(width, height, pixels),
            ..self
        }
    }

    /// Spots of an element's cones under `force` in its frame `E_i` (N).
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
                contrast: 1.0,
            }
        })
    }

    /// Number of spots in an image.
    pub(crate) fn spot_count(&self) -> usize {
        let markers = self.config.markers.as_ref();
        let per_element = markers.map_or(CONES, |markers| markers.per_element);
        per_element * self.layout.elements.len()
    }

    /// Width of the image, padded to whole noise blocks.
    pub(crate) fn padded_width(&self) -> usize {
        self.light_lost_by_column.len()
    }

    /// Contact area of a cone per load (m²/N).
    pub fn area_per_load(&self) -> f64 {
        self.area_per_load
    }
}

/// Maximum and mean number of pixels per metre of the dome within `radius` of an element's axis.
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
        let place = radius * direction_at(TAU * k as f64 / CONES as f64);
        let seen = |offset| projection.project(projection.lift(place + offset, own)?);
        let along_x = (seen(DVec2::X * step)? - seen(DVec2::ZERO)?) / step;
        let along_y = (seen(DVec2::Y * step)? - seen(DVec2::ZERO)?) / step;
        // Larger singular value of the local map.
        let mean = (along_x.length_squared() + along_y.length_squared()) / 2.0;
        let area = along_x.perp_dot(along_y);
        let square = mean + (mean * mean - area * area).max(0.0).sqrt();
        largest = largest.max(square.sqrt());
    }
    let area = projection
        .dewarp(projection.project(layout.tip(element))?, own)?
        .area;
    Some((largest, area.sqrt().recip()))
}

/// Coordinates x, y and z in `T` of the dome's point at each pixel (m); far away for pixels without a point.
fn dome_points(projection: &DomeProjection) -> [Vec<f32>; 3] {
    let (width, height) = (projection.width(), projection.height());
    let mut points = [(); 3].map(|()| Vec::with_capacity(width * height));
    for row in 0..height {
        for column in 0..width {
            let pixel = DVec2::new(column as f64, row as f64);
            // A metre away from the dome, out of reach of all spots.
            let point = projection.point_at(pixel).unwrap_or(DVec3::ONE);
            for (points, coordinate) in points.iter_mut().zip(point.to_array()) {
                points.push(coordinate as f32);
            }
        }
    }
    points
}

/// Relative loss of light due to vignetting along one axis of the image.
fn light_lost(pixels: usize, centre: f64, per_square: f64) -> Vec<f32> {
    (0..pixels.next_multiple_of(NOISE_LANES))
        .map(|pixel| (per_square * (pixel as f64 - centre).powi(2)) as f32)
        .collect()
}
