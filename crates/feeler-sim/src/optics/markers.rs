//! Fingertips with visible markers on each element: pins, fibre ends, or dots on a gel.
//!
//! The skin between elements is elastic. A displacement of the skin decays with the distance `d` from the loaded
//! element as `w = exp(-d² / 2 s²)`, where `s` is the spread. A force `F_t, F_z` on element j displaces the marker of
//! element i at the distance vector `D` by
//!
//! ```text
//! u = w (F_t / k_t + (l / s²) D F_z / k_n)         across the skin
//! z = w (F_z + (h / s²) D · F_t) / k_n             into it, towards the camera
//! ```
//!
//! The skin sinks in by `w F_z / k_n`, and a pin of length `l` on its inside turns with the skin's slope, so pins move
//! away from a normal load. A shear force at the height `h` above the skin depresses it ahead and lifts it behind. A
//! marker that is nearer to the camera appears larger, and brighter by `brightening z`.

use super::error::{OpticsError, in_range};
use super::spot::Spot;
use feeler::math::direction_at;
use feeler::sensor::fingertip::{DomeProjection, ElementLayout};
use glam::{DMat3, DVec2, DVec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Maximum distance at which a force displaces markers, in units of the spread.
const REACH: f64 = 3.0;
/// Maximum number of markers per element.
const MAX_PER_ELEMENT: f64 = 64.0;

/// Parameters of a fingertip's markers and of the skin that carries them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MarkerConfig {
    /// Radius of a marker (m).
    pub radius: f64,
    /// Number of markers per element.
    #[serde(default = "one")]
    pub per_element: usize,
    /// Radius of the circle of an element's markers about its axis (m). Not used for a single marker, which is on the
    /// axis.
    #[serde(default)]
    pub circle_radius: f64,
    /// Ratio of normal force to inward displacement of a marker (N/m).
    pub normal_stiffness: f64,
    /// Ratio of shear force to tangential displacement of a marker (N/m).
    pub shear_stiffness: f64,
    /// Distance at which the skin's displacement falls to exp(-1/2) (m). With 0, elements are independent.
    #[serde(default)]
    pub spread: f64,
    /// Length of the pin under the skin that carries a marker at its end (m). With 0, the marker is in the skin.
    #[serde(default)]
    pub pin_length: f64,
    /// Height above the skin at which a shear force acts (m).
    #[serde(default)]
    pub nodule_height: f64,
    /// Relative increase of a marker's contrast per displacement towards the camera (1/m).
    #[serde(default)]
    pub brightening: f64,
    /// Maximum relative variation of contrast between markers (uniform). Equal for all fingertips of a layout.
    #[serde(default)]
    pub variation: f64,
}

fn one() -> usize {
    1
}

impl MarkerConfig {
    /// Positions of an element's markers, x and y in its frame (m).
    fn places(&self) -> Vec<DVec2> {
        match self.per_element {
            1 => vec![DVec2::ZERO],
            count => (0..count)
                .map(|k| self.circle_radius * direction_at(TAU * (k as f64 + 0.5) / count as f64))
                .collect(),
        }
    }

    /// Radius about an element's axis that contains its markers (m).
    pub(crate) fn reach(&self) -> f64 {
        let ring = if self.per_element > 1 {
            self.circle_radius
        } else {
            0.0
        };
        (ring + self.radius).max(self.spread)
    }

    /// Checks that values are in the range that can be rendered.
    pub(crate) fn check(&self) -> Result<(), OpticsError> {
        let positive = f64::MIN_POSITIVE;
        in_range(&[
            ("markers.radius", self.radius, positive, 0.1),
            (
                "markers.per_element",
                self.per_element as f64,
                1.0,
                MAX_PER_ELEMENT,
            ),
            ("markers.circle_radius", self.circle_radius, 0.0, 0.1),
            (
                "markers.normal_stiffness",
                self.normal_stiffness,
                positive,
                1e12,
            ),
            (
                "markers.shear_stiffness",
                self.shear_stiffness,
                positive,
                1e12,
            ),
            ("markers.spread", self.spread, 0.0, 0.1),
            ("markers.pin_length", self.pin_length, 0.0, 0.1),
            ("markers.nodule_height", self.nodule_height, 0.0, 0.1),
            ("markers.brightening", self.brightening, -1e5, 1e5),
            ("markers.variation", self.variation, 0.0, 0.99),
        ])
    }
}

/// Effect of a force `(F_x, F_y, F_z)` on one element, in its frame, on a marker: displacement `(u_x, u_y, z)` in the
/// frame of the marker's element (m).
#[derive(Debug, Clone, Copy)]
struct Influence {
    of: usize,
    compliance: DMat3,
}

/// One marker.
#[derive(Debug, Clone)]
struct Marker {
    element: usize,
    /// Position without load, x and y in its element's frame (m).
    place: DVec2,
    /// Contrast relative to the mean.
    contrast: f64,
    /// Distance from the camera's pinhole (m).
    distance: f64,
    /// Elements whose forces displace it.
    influences: Vec<Influence>,
}

/// Displacements of markers under forces.
#[derive(Debug, Clone)]
pub(crate) struct MarkerModel {
    config: MarkerConfig,
    markers: Vec<Marker>,
}

impl MarkerModel {
    pub fn new(config: &MarkerConfig, layout: &ElementLayout, projection: &DomeProjection) -> Self {
        // A fixed seed: contrasts belong to the fingertip, not to a run.
        let mut rng = Pcg64::seed_from_u64(0);
        let places = config.places();
        let markers = (0..layout.elements.len())
            .flat_map(|element| places.iter().map(move |&place| (element, place)))
            .map(|(element, place)| {
                let on_marker = (0..layout.elements.len()).filter_map(|of| {
                    let compliance = compliance(config, layout, element, place, of)?;
                    Some(Influence { of, compliance })
                });
                Marker {
                    element,
                    place,
                    contrast: 1.0 + config.variation * (2.0 * rng.random::<f64>() - 1.0),
                    distance: layout.tip(element).distance(projection.pinhole()),
                    influences: on_marker.collect(),
                }
            });
        Self {
            config: config.clone(),
            markers: markers.collect(),
        }
    }

    /// Spots of all markers under `forces` on all elements (N), each with the index of the element in whose frame it
    /// is.
    pub fn spots(&self, forces: &[DVec3]) -> impl Iterator<Item = (usize, Spot)> {
        self.markers.iter().map(|marker| {
            let moved = marker
                .influences
                .iter()
                .fold(DVec3::ZERO, |moved, influence| {
                    moved + influence.compliance * forces[influence.of]
                });
            // Limits the approach to half of the distance to the camera.
            let nearer = marker.distance / (marker.distance - moved.z.min(0.5 * marker.distance));
            let spot = Spot {
                load: forces[marker.element].z,
                centre: marker.place + moved.truncate(),
                radius: self.config.radius * nearer,
                contrast: marker.contrast * (1.0 + self.config.brightening * moved.z).max(0.0),
            };
            (marker.element, spot)
        })
    }
}

/// Compliance of the marker at `place` of `element` for a force on element `of`. `None` if the force has no effect.
fn compliance(
    config: &MarkerConfig,
    layout: &ElementLayout,
    element: usize,
    place: DVec2,
    of: usize,
) -> Option<DMat3> {
    let to_marker = layout.elements[element].rotation.transpose();
    let away = to_marker * (layout.tip(element) - layout.tip(of)) + place.extend(0.0);
    if element != of && away.length() > REACH * config.spread {
        return None;
    }
    let per_square = match config.spread > 0.0 {
        true => config.spread.powi(-2),
        false => 0.0,
    };
    let share = libm::exp(-0.5 * away.length_squared() * per_square);
    let slope = per_square * away.truncate();
    let turned = to_marker * layout.elements[of].rotation;
    let shear = [DVec3::X, DVec3::Y].map(|axis| {
        let along = (turned * axis).truncate();
        let sinks = config.nodule_height * slope.dot(along) / config.normal_stiffness;
        (along / config.shear_stiffness).extend(sinks)
    });
    let pressed = (config.pin_length * slope).extend(1.0) / config.normal_stiffness;
    Some(share * DMat3::from_cols(shear[0], shear[1], pressed))
}
