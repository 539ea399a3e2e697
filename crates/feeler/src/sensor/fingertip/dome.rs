//! Camera model of the inside of the dome, and the dewarping of its images.
//!
//! # Axes
//!
//! The camera is on the dome's axis, behind the dome's centre, and looks outward along x of the fingertip frame `T`.
//! Columns of the image increase along y of `T`, rows along z of `T`: the image is not mirrored. Pixel
//! `(column, row)` has its centre at exactly these coordinates, so the top left pixel covers -0.5..0.5 px in both.
//!
//! # Sphere of the spots
//!
//! The conical feelers touch the acrylic dome below the tips, by the length of a feeler. This length is small and
//! unknown, so bright spots are assumed to lie on the sphere of the tips, `dome_radius`. The calibration absorbs the
//! resulting constant scale of lengths in an element's plane.

use super::layout::SensingElement;
use crate::sensor::image::radial_distortion::RadialDistortion;
use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

/// Camera of a fingertip: a pinhole with radial distortion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CameraConfig {
    /// Columns of the image, px.
    pub width: usize,
    /// Rows of the image, px.
    pub height: usize,
    /// Focal length, px (assumed).
    pub focal_length_px: f64,
    /// Distance of the pinhole behind the dome's centre, on its axis, m (assumed). The pinhole must lie inside the
    /// dome.
    pub standoff: f64,
    /// Column and row of the dome's axis in the image, px; the centre of the image if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub centre_px: Option<[f64; 2]>,
    /// Radial distortion `k1, k2`: a ray at slope `r` from the axis (the tangent of its angle) is imaged at
    /// `r (1 + k1 r^2 + k2 r^4)` focal lengths from the centre. Negative values are barrel distortion.
    pub radial_distortion: [f64; 2],
}

impl Default for CameraConfig {
    /// Camera whose image contains all 41 elements of the reference layout, up to the rim of the outermost sub-regions.
    fn default() -> Self {
        Self {
            width: 640,
            height: 480,
            focal_length_px: 195.0,
            standoff: 0.010,
            centre_px: None,
            radial_distortion: [0.0, 0.0],
        }
    }
}

/// Maximum number of pixels of an image; precomputed tables take about twenty bytes per pixel.
pub const MAX_PICTURE_PIXELS: usize = 1 << 22;

/// Maximum number of pixels along one side of an image.
pub const MAX_PICTURE_SIDE: usize = 4096;

/// Error of a camera model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DomeError {
    /// The image is empty or too large.
    #[error(
        "camera: width x height must be 1 to {MAX_PICTURE_SIDE} px each and at most {MAX_PICTURE_PIXELS} px in total, got {width}x{height} px"
    )]
    PictureSize {
        /// Width of the image, px.
        width: usize,
        /// Height of the image, px.
        height: usize,
    },
    /// A length is not a positive number.
    #[error("{name} must be a positive number, got {value}")]
    NotPositive {
        /// Name of the value.
        name: &'static str,
        /// The invalid value.
        value: f64,
    },
    /// A value is infinite or NaN.
    #[error("{name} must be a finite number, got {value}")]
    NotFinite {
        /// Name of the value.
        name: &'static str,
        /// The invalid value.
        value: f64,
    },
    /// The pinhole lies outside the dome, so that rays could miss it.
    #[error(
        "the pinhole must lie inside the dome: standoff {standoff} m must be less than its radius {dome_radius} m"
    )]
    PinholeOutside {
        /// Distance of the pinhole from the dome's centre, m.
        standoff: f64,
        /// Radius of the dome, m.
        dome_radius: f64,
    },
}

/// A point of the image, mapped to the tangent plane of an element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dewarped {
    /// Position of the point on the dome, relative to the element's axis, in x, y of the frame `E_i` (m).
    pub point: DVec2,
    /// Area of the tangent plane covered by one pixel, m² per px².
    pub area: f64,
}

/// Projection between points of the dome and pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct DomeProjection {
    width: usize,
    height: usize,
    dome_radius: f64,
    focal_length: f64,
    standoff: f64,
    centre: DVec2,
    distortion: RadialDistortion,
}

impl DomeProjection {
    /// Creates the projection of `camera` in a dome of radius `dome_radius`, m.
    ///
    /// # Errors
    /// If the image is empty or too large, a value is not finite or has the wrong sign, or the pinhole lies outside
    /// the dome.
    pub fn new(camera: &CameraConfig, dome_radius: f64) -> Result<Self, DomeError> {
        let CameraConfig { width, height, .. } = *camera;
        let sides = 1..=MAX_PICTURE_SIDE;
        let fits = sides.contains(&width) && sides.contains(&height);
        if !(fits && width * height <= MAX_PICTURE_PIXELS) {
            return Err(DomeError::PictureSize { width, height });
        }
        let centre = camera
            .centre_px
            .unwrap_or([(width - 1) as f64 / 2.0, (height - 1) as f64 / 2.0]);
        let [k1, k2] = camera.radial_distortion;
        positive("dome_radius", dome_radius)?;
        positive("focal_length_px", camera.focal_length_px)?;
        finite("standoff", camera.standoff)?;
        finite("centre_px[0]", centre[0])?;
        finite("centre_px[1]", centre[1])?;
        finite("radial_distortion[0]", k1)?;
        finite("radial_distortion[1]", k2)?;
        if camera.standoff.abs() >= dome_radius {
            return Err(DomeError::PinholeOutside {
                standoff: camera.standoff,
                dome_radius,
            });
        }
        Ok(Self {
            width,
            height,
            dome_radius,
            focal_length: camera.focal_length_px,
            standoff: camera.standoff,
            centre: DVec2::from_array(centre),
            distortion: RadialDistortion::new(k1, k2),
        })
    }

    /// Position of the pinhole in the fingertip frame `T`, m.
    pub fn pinhole(&self) -> DVec3 {
        DVec3::new(-self.standoff, 0.0, 0.0)
    }

    /// Radius of the dome, m.
    pub fn dome_radius(&self) -> f64 {
        self.dome_radius
    }

    /// Columns of the image, px.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows of the image, px.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Column and row of the dome's axis in the image, px.
    pub fn centre(&self) -> DVec2 {
        self.centre
    }

    /// Projects `point` (m, in `T`) to column and row, px, which may lie outside the image.
    ///
    /// `None` if the point is not in front of the pinhole, or so far off the axis that the distortion is not
    /// monotonic.
    pub fn project(&self, point: DVec3) -> Option<DVec2> {
        let depth = point.x + self.standoff;
        if depth <= 0.0 {
            return None;
        }
        let slope = DVec2::new(point.y, point.z) / depth;
        let scale = self.distortion.scale(slope.length())?;
        Some(self.centre + self.focal_length * scale * slope)
    }

    /// Point of the dome (m, in `T`) that is imaged at column and row `pixel`, px.
    ///
    /// `None` if no ray is imaged at that pixel.
    pub fn point_at(&self, pixel: DVec2) -> Option<DVec3> {
        let distorted = (pixel - self.centre) / self.focal_length;
        let slope = distorted / self.distortion.inverse_scale(distorted.length())?;
        let direction = DVec3::new(1.0, slope.x, slope.y).normalize();
        // |pinhole + t direction| = dome_radius, with the pinhole at (-standoff, 0, 0) inside.
        let along = self.standoff * direction.x;
        let t = along
            + (along * along + self.dome_radius.powi(2) - self.standoff * self.standoff).sqrt();
        Some(t * direction - DVec3::new(self.standoff, 0.0, 0.0))
    }

    /// Point of the dome (m, in `T`) above `plane` (m, x and y of the element's frame).
    ///
    /// The projection is along the element's normal, the direction of the conical feelers. `None` if the projection
    /// misses the dome.
    pub fn lift(&self, plane: DVec2, element: &SensingElement) -> Option<DVec3> {
        let height = self.dome_radius.powi(2) - plane.length_squared();
        (height >= 0.0).then(|| element.rotation * plane.extend(height.sqrt()))
    }

    /// Maps column and row `pixel`, px, to the tangent plane of `element` (dewarping).
    ///
    /// `None` if no ray is imaged at that pixel, or if the pixel shows the opposite half of the dome.
    pub fn dewarp(&self, pixel: DVec2, element: &SensingElement) -> Option<Dewarped> {
        let plane = |offset: DVec2| {
            let point = element.rotation.transpose() * self.point_at(pixel + offset)?;
            (point.z > 0.0).then_some(point.truncate())
        };
        let half = 0.5;
        let along_column = plane(DVec2::new(half, 0.0))? - plane(DVec2::new(-half, 0.0))?;
        let along_row = plane(DVec2::new(0.0, half))? - plane(DVec2::new(0.0, -half))?;
        Some(Dewarped {
            point: plane(DVec2::ZERO)?,
            area: along_column.perp_dot(along_row).abs(),
        })
    }
}

fn positive(name: &'static str, value: f64) -> Result<(), DomeError> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(DomeError::NotPositive { name, value })
    }
}

fn finite(name: &'static str, value: f64) -> Result<(), DomeError> {
    if value.is_finite() {
        Ok(())
    } else {
        Err(DomeError::NotFinite { name, value })
    }
}
