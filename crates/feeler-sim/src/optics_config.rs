//! What the simulated fingertip is made of.

use super::markers::MarkerConfig;
use serde::{Deserialize, Serialize};

/// Most noise of a camera, grey levels. In the brightest pixel both together are 36 levels, the most that pictures are drawn with.
const MAX_READ_NOISE: f64 = 30.0;
const MAX_SHOT_NOISE: f64 = 1.2;

/// Rubber, light and camera of a simulated fingertip.
///
/// The paper gives none of these numbers; all are assumed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct OpticsConfig {
    /// Young's modulus of the silicone rubber, Pa (assumed, typical of such feelers).
    pub youngs_modulus: f64,
    /// Poisson's ratio of the rubber (assumed, nearly incompressible).
    pub poisson_ratio: f64,
    /// Angle between a cone's flank and the dome before they touch, degrees (assumed: the spots of
    /// flatter cones would run into each other at full load).
    pub cone_flank_deg: f64,
    /// Radius of a cone's base, m; its contact cannot grow beyond (assumed).
    pub cone_base_radius: f64,
    /// Radius of the circle about the element's axis on which its eight cones stand, m (assumed: up to
    /// 2 N of compression and 1.8 N of shear, all spots but their rims stay in a sub-region of 2.6 mm).
    pub cone_circle_radius: f64,
    /// Height over the cones' tips at which a shear force acts on the feeler, m (assumed).
    pub lever_height: f64,
    /// Load on each cone of an unloaded element, N (assumed).
    pub preload: f64,
    /// Shear stiffness with which the cones carry the column, N/m (assumed).
    pub shear_stiffness: f64,
    /// Grey level of the dome where nothing touches it, at the picture's centre (assumed).
    pub background_gray: f64,
    /// Grey level of a bright spot or of a marker, at the picture's centre; markers may be darker than the dome (assumed).
    pub spot_gray: f64,
    /// Part of the light that is lost half a picture's width off the centre, growing with the square
    /// of the distance (assumed).
    pub vignetting: f64,
    /// Half the width of a spot's blurred edge, px (assumed).
    pub blur_px: f64,
    /// Standard deviation of the read noise, grey levels (assumed).
    pub read_noise: f64,
    /// Standard deviation of the shot noise of one grey level; it grows with the root of the gray
    /// value (assumed).
    pub shot_noise: f64,
    /// A marker for each element in place of its eight cones: where they stand is not used then.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub markers: Option<MarkerConfig>,
}

impl Default for OpticsConfig {
    fn default() -> Self {
        Self {
            youngs_modulus: 0.7e6,
            poisson_ratio: 0.49,
            cone_flank_deg: 65.0,
            cone_base_radius: 0.7e-3,
            cone_circle_radius: 1.8e-3,
            lever_height: 0.8e-3,
            preload: 0.05,
            shear_stiffness: 8.0e3,
            background_gray: 20.0,
            spot_gray: 190.0,
            vignetting: 0.2,
            blur_px: 1.2,
            read_noise: 1.5,
            shot_noise: 0.1,
            markers: None,
        }
    }
}

/// Why a simulated fingertip cannot be built or drawn.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum OpticsError {
    /// A value of the configuration makes no sense.
    #[error("{name} must lie between {low} and {high}, got {value}")]
    OutOfRange {
        /// The field.
        name: &'static str,
        /// Least value.
        low: f64,
        /// Greatest value.
        high: f64,
        /// What it was.
        value: f64,
    },
    /// A cone of an unloaded element does not touch the dome where the camera sees it.
    #[error("the camera does not see the cones of element {element}")]
    Unseen {
        /// Index of the element.
        element: usize,
    },
    /// The number of forces is not that of the elements.
    #[error("forces for {expected} elements expected, got {actual}")]
    ElementCount {
        /// Elements of the fingertip.
        expected: usize,
        /// Forces that arrived.
        actual: usize,
    },
    /// The picture to draw has another size than the camera's.
    #[error(
        "a picture of {expected_width}x{expected_height} px expected, got {width}x{height} px in {pixels} values"
    )]
    PictureSize {
        /// Columns of the camera's pictures, px.
        expected_width: usize,
        /// Rows of the camera's pictures, px.
        expected_height: usize,
        /// Columns of the picture, px.
        width: usize,
        /// Rows of the picture, px.
        height: usize,
        /// Gray values in the picture.
        pixels: usize,
    },
}

impl OpticsConfig {
    /// Refuses values outside of what the model can draw.
    ///
    /// # Errors
    /// Names the field, its range and its value.
    pub fn check(&self) -> Result<(), OpticsError> {
        let positive = f64::MIN_POSITIVE;
        let darkest = match self.markers {
            Some(_) => 0.0,
            None => self.background_gray,
        };
        in_range(&[
            ("youngs_modulus", self.youngs_modulus, positive, 1e12),
            ("poisson_ratio", self.poisson_ratio, 0.0, 0.5),
            ("cone_flank_deg", self.cone_flank_deg, 1.0, 89.0),
            ("cone_base_radius", self.cone_base_radius, positive, 0.1),
            ("cone_circle_radius", self.cone_circle_radius, positive, 0.1),
            ("lever_height", self.lever_height, 0.0, 0.1),
            ("preload", self.preload, 0.0, 1e3),
            ("shear_stiffness", self.shear_stiffness, positive, 1e12),
            ("background_gray", self.background_gray, 0.0, 255.0),
            ("spot_gray", self.spot_gray, darkest, 255.0),
            ("vignetting", self.vignetting, 0.0, 0.6),
            ("blur_px", self.blur_px, 0.1, 100.0),
            ("read_noise", self.read_noise, 0.0, MAX_READ_NOISE),
            ("shot_noise", self.shot_noise, 0.0, MAX_SHOT_NOISE),
        ])?;
        self.markers.as_ref().map_or(Ok(()), MarkerConfig::check)
    }
}

/// Refuses a value, `(name, value, lowest, highest)`, that is out of its range.
pub(super) fn in_range(values: &[(&'static str, f64, f64, f64)]) -> Result<(), OpticsError> {
    let out = values
        .iter()
        .find(|(_, value, low, high)| !(low..=high).contains(&value));
    match out {
        None => Ok(()),
        Some(&(name, value, low, high)) => Err(OpticsError::OutOfRange {
            name,
            low,
            high,
            value,
        }),
    }
}
