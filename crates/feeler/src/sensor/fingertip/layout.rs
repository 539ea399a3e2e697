//! Arrangement of the sensing elements on the dome.

use crate::check::Checker;
use glam::{DMat3, DVec2, DVec3};
use serde::{Deserialize, Serialize};

/// Maximum number of elements of a fingertip.
pub const MAX_ELEMENTS: usize = 512;

/// Arrangement of sensing elements on a dome: concentric rings (paper, section II) or a grid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LayoutConfig {
    /// Radius of the sphere on which the tips of the unloaded columnar feelers lie, m.
    pub dome_radius: f64,
    /// Rings from the apex outward; empty if there is a grid.
    pub rings: Vec<RingConfig>,
    /// Grid of elements; replaces the rings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub grid: Option<GridConfig>,
}

impl Default for LayoutConfig {
    /// The reference fingertip: 41 elements in rings of 1, 8, 12 and 20. Their total number is from the paper;
    /// arrangement and radius are assumed.
    fn default() -> Self {
        let rings = [(1, 0.0), (8, 22.5), (12, 45.0), (20, 67.5)];
        Self {
            dome_radius: 0.018,
            rings: rings
                .map(|(elements, polar_angle_deg)| RingConfig {
                    elements,
                    polar_angle_deg,
                })
                .into(),
            grid: None,
        }
    }
}

impl LayoutConfig {
    /// Number of elements on all rings, or in the grid.
    pub fn element_count(&self) -> usize {
        let in_rings = self
            .rings
            .iter()
            .fold(0, |sum: usize, ring| sum.saturating_add(ring.elements));
        let grid = self.grid.as_ref().map_or(0, GridConfig::element_count);
        in_rings.saturating_add(grid)
    }

    /// Checks that every value of the table `key` is in its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        checker.between(&format!("{key}.dome_radius"), self.dome_radius, 1e-3, 1.0);
        checker.require(
            &format!("{key}.rings"),
            format!("{} rings", self.rings.len()),
            self.rings.is_empty() == self.grid.is_some(),
            "at least one ring, as in [{ elements = 8, polar_angle_deg = 22.5 }], or a grid with rings = []",
        );
        if let Some(grid) = &self.grid {
            let key = format!("{key}.grid");
            for (field, count) in [("columns", grid.columns), ("rows", grid.rows)] {
                checker.require(
                    &format!("{key}.{field}"),
                    count.to_string(),
                    (1..=MAX_ELEMENTS).contains(&count),
                    &format!("1 to {MAX_ELEMENTS}"),
                );
            }
            let spacing = grid.spacing;
            checker.between(&format!("{key}.spacing"), spacing, 1e-4, self.dome_radius);
        }
        for (index, ring) in self.rings.iter().enumerate() {
            let key = format!("{key}.rings[{index}]");
            checker.require(
                &format!("{key}.elements"),
                ring.elements.to_string(),
                (1..=MAX_ELEMENTS).contains(&ring.elements),
                &format!("1 to {MAX_ELEMENTS}"),
            );
            let angle = ring.polar_angle_deg;
            checker.between(&format!("{key}.polar_angle_deg"), angle, 0.0, 180.0);
        }
    }
}

/// One ring of equally spaced sensing elements.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RingConfig {
    /// Number of elements on the ring, at least 1.
    pub elements: usize,
    /// Angle between the dome's axis and the ring's elements, degrees; 0 is the apex.
    pub polar_angle_deg: f64,
}

/// A square grid of sensing elements around the apex.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GridConfig {
    /// Number of elements along y of the fingertip frame `T`, at least 1.
    pub columns: usize,
    /// Number of elements along z of `T`, at least 1.
    pub rows: usize,
    /// Spacing of neighbours at the apex, along the dome, m.
    pub spacing: f64,
}

impl GridConfig {
    fn element_count(&self) -> usize {
        self.columns.saturating_mul(self.rows)
    }

    /// Directions of the elements in `T`, row by row. The arc length from the apex to an element equals the element's
    /// distance from the middle of the planar grid.
    fn directions(&self, dome_radius: f64) -> impl Iterator<Item = DVec3> {
        let off_middle = |index: usize, count: usize| index as f64 - 0.5 * (count as f64 - 1.0);
        (0..self.element_count()).map(move |index| {
            let (row, column) = (index / self.columns, index % self.columns);
            let place = DVec2::new(off_middle(column, self.columns), off_middle(row, self.rows));
            let angle = place.length() * self.spacing / dome_radius;
            let across = libm::sin(angle) * place.normalize_or_zero();
            DVec3::new(libm::cos(angle), across.x, across.y)
        })
    }
}

/// One sensing element: a columnar feeler on eight conical feelers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensingElement {
    /// Ring of the element, 0 at the apex; 0 in a grid.
    pub ring: usize,
    /// Rotation of the element's frame `E_i` in the fingertip frame `T`: columns are x and y,
    /// tangent to the dome (y along its parallel, x away from the apex along its meridian), and z,
    /// the outward normal.
    pub rotation: DMat3,
}

impl SensingElement {
    /// Creates the element whose outward normal is along `direction` (a unit vector in `T`). Its frame is oriented like
    /// those on rings. Within a degree of the apex, where noise would determine the meridian, x of the element is along
    /// y of `T`, as at the apex. The ring is unknown and set to 0.
    pub fn facing(direction: DVec3) -> Self {
        let off_axis = libm::hypot(direction.y, direction.z);
        let rotation = if direction.x > 0.0 && off_axis < libm::sin(1_f64.to_radians()) {
            let normal = direction.normalize();
            let x = DVec3::Y.reject_from_normalized(normal).normalize();
            DMat3::from_cols(x, normal.cross(x), normal)
        } else {
            let azimuth = libm::atan2(direction.z, direction.y);
            element_rotation(libm::atan2(off_axis, direction.x), azimuth)
        };
        Self { ring: 0, rotation }
    }

    /// Outward normal of the dome at the element, a unit vector in `T`.
    pub fn normal(&self) -> DVec3 {
        self.rotation.z_axis
    }

    /// Converts a `force` of a [`TactileFrame`](crate::sensor::forces::reading::TactileFrame) (`F_x`, `F_y` and the compression
    /// `F_z`, N) to the force on the element by the object, N, in `T`.
    pub fn force_on_fingertip(&self, force: DVec3) -> DVec3 {
        // Compression is positive along the inward normal.
        self.rotation * force.with_z(-force.z)
    }
}

/// Sensing elements of one fingertip, ring by ring from the apex.
#[derive(Debug, Clone, PartialEq)]
pub struct ElementLayout {
    /// Radius of the sphere on which the unloaded tips lie, m.
    pub dome_radius: f64,
    /// The elements, ring by ring or row by row.
    pub elements: Vec<SensingElement>,
}

impl ElementLayout {
    /// Computes the elements described by `config`.
    ///
    /// Within a ring, element j of n is at azimuth `2 pi j / n` about the dome's axis (x of `T`), from y of `T`
    /// towards z of `T`. The elements of a grid are placed row by row along z of `T`.
    pub fn new(config: &LayoutConfig) -> Self {
        let grid = config.grid.iter();
        let in_grid = grid.flat_map(|grid| grid.directions(config.dome_radius));
        let elements = config
            .rings
            .iter()
            .enumerate()
            .flat_map(|(ring, r)| {
                (0..r.elements).map(move |j| {
                    let azimuth = std::f64::consts::TAU * j as f64 / r.elements as f64;
                    SensingElement {
                        ring,
                        rotation: element_rotation(r.polar_angle_deg.to_radians(), azimuth),
                    }
                })
            })
            .chain(in_grid.map(SensingElement::facing))
            .collect();
        Self {
            dome_radius: config.dome_radius,
            elements,
        }
    }

    /// Tip of the unloaded element `index`, m, in the fingertip frame `T` (origin: dome centre).
    pub fn tip(&self, index: usize) -> DVec3 {
        self.dome_radius * self.elements[index].normal()
    }

    /// Elements with their unloaded tips, m in `T`.
    pub fn places(&self) -> impl Iterator<Item = (SensingElement, DVec3)> + '_ {
        let elements = self.elements.iter();
        elements.map(|&element| (element, self.dome_radius * element.normal()))
    }
}

/// Frame of the element at the angle `polar` from x of `T` and at `azimuth` from y of `T` towards z of `T`, rad.
fn element_rotation(polar: f64, azimuth: f64) -> DMat3 {
    let (sin_polar, cos_polar) = libm::sincos(polar);
    let (sin_azimuth, cos_azimuth) = libm::sincos(azimuth);
    let normal = DVec3::new(cos_polar, sin_polar * cos_azimuth, sin_polar * sin_azimuth);
    let meridian = DVec3::new(-sin_polar, cos_polar * cos_azimuth, cos_polar * sin_azimuth);
    DMat3::from_cols(meridian, normal.cross(meridian), normal)
}
