//! Parameters of the simulated fingertip's optics and camera.

use super::error::{OpticsError, in_range};
use super::markers::MarkerConfig;
use serde::{Deserialize, Serialize};

/// Maximum of `read_noise` (gray levels). Together with the maximum of `shot_noise`, it gives a standard deviation of
/// 36 gray levels in the brightest pixel, the most that the renderer's 16-bit integers can represent.
const MAX_READ_NOISE: f64 = 30.0;
/// Maximum of `shot_noise` (gray levels).
const MAX_SHOT_NOISE: f64 = 1.2;

/// Rubber, light and camera of a simulated fingertip.
///
/// The paper does not give these numbers; all are assumed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct OpticsConfig {
    /// Young's modulus of the silicone rubber (Pa); typical of such feelers.
    pub youngs_modulus: f64,
    /// Poisson's ratio of the rubber; nearly incompressible.
    pub poisson_ratio: f64,
    /// Angle between a cone's flank and the dome without load (degrees). With flatter cones, spots would merge at full
    /// load.
    pub cone_flank_deg: f64,
    /// Radius of a cone's base (m), which limits its contact.
    pub cone_base_radius: f64,
    /// Radius of the circle of an element's eight cones about its axis (m). Up to 2 N of compression and 1.8 N of
    /// shear, all spots except their rims remain in a sub-region of 2.6 mm.
    pub cone_circle_radius: f64,
    /// Height above the cones' tips at which a shear force acts on the feeler (m).
    pub lever_height: f64,
    /// Load on each cone of an unloaded element (N).
    pub preload: f64,
    /// Shear stiffness of the cones that carry the column (N/m).
    pub shear_stiffness: f64,
    /// Gray level of the dome without contact, at the image's centre.
    pub background_gray: f64,
    /// Gray level of a bright spot or marker, at the image's centre. Markers may be darker than the dome.
    pub spot_gray: f64,
    /// Relative loss of light at half the image's width from the centre; it increases with the square of the distance.
    pub vignetting: f64,
    /// Half of the width of a spot's blurred edge (px).
    pub blur_px: f64,
    /// Standard deviation of the read noise (gray levels).
    pub read_noise: f64,
    /// Standard deviation of the shot noise at gray level 1; it increases with the square root of the gray level.
    pub shot_noise: f64,
    /// Markers instead of cones. The parameters of cones are not used then.
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

impl OpticsConfig {
    /// Checks that values are in the range that can be rendered.
    ///
    /// # Errors
    /// [`OpticsError::OutOfRange`] for the first value that is not.
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
