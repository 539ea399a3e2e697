//! Markers of a gel, and their positions in the image of a camera behind it.

use super::scenario::Gel;
use feeler::sensor::fingertip::{ElementLayout, SensingElement};
use feeler_sim::optics::GelLayer;
use feeler_sim::random::normal;
use glam::{DMat3, DVec2, DVec3};
use rand_pcg::Pcg64;

/// Width and height of the image (px): those of GelSight Mini images at a quarter of the resolution.
pub const PICTURE: (usize, usize) = (320, 240);
/// Width of the field of view (m), that of the GelSight Mini.
const FIELD: f64 = 0.0186;
const PX_PER_M: f64 = PICTURE.0 as f64 / FIELD;
/// Markers that are closer to the border than this number of spacings are cut off and not located.
const BORDER: f64 = 0.3;

/// The markers of one gel.
pub struct Markers {
    gel: Gel,
    layer: GelLayer,
    /// Position of each marker on the gel, relative to the image centre (m): x along y of the fingertip, y along z.
    places: Vec<DVec2>,
    /// Deviation of each marker from the regular grid (px).
    off: Vec<DVec2>,
    /// Creep displacement of each marker (m): along x and y, and inward.
    crept: Vec<DVec3>,
}

impl Markers {
    /// Creates the markers of `gel`, with random deviations from the regular grid.
    pub fn new(gel: Gel, random: &mut Pcg64) -> Self {
        let spacing = gel.spacing / PX_PER_M;
        let count = |side: usize| (side as f64 / gel.spacing) as usize + 1;
        let (columns, rows) = (count(PICTURE.0), count(PICTURE.1));
        let middle = DVec2::new(columns as f64 - 1.0, rows as f64 - 1.0) / 2.0;
        let place = |index: usize| {
            let index = DVec2::new((index % columns) as f64, (index / columns) as f64);
            spacing * (index - middle)
        };
        let border = DVec2::splat(BORDER * gel.spacing);
        let in_picture = |place: &DVec2| {
            let seen = seen(&gel, *place, 0.0);
            seen.cmpge(border).all() && seen.cmple(size() - border).all()
        };
        let places = (0..columns * rows).map(place).filter(in_picture);
        let places: Vec<_> = places.collect();
        let deviation = gel.irregularity * gel.spacing;
        let mut two = || DVec2::new(normal(random, deviation), normal(random, deviation));
        Self {
            layer: gel.layer(spacing, FIELD + 2.0 * spacing),
            off: places.iter().map(|_| two()).collect(),
            crept: vec![DVec3::ZERO; places.len()],
            places,
            gel,
        }
    }

    /// Returns the markers as elements of a nearly flat fingertip, with x of each along y of the fingertip, and y
    /// along z.
    pub fn elements(&self) -> ElementLayout {
        let radius = self.gel.radius;
        let element = |place: &DVec2| {
            let out = (radius * radius - place.length_squared()).sqrt();
            let normal = DVec3::new(out, place.x, place.y) / radius;
            let x = DVec3::Y.reject_from_normalized(normal).normalize();
            SensingElement {
                ring: 0,
                rotation: DMat3::from_cols(x, normal.cross(x), normal),
            }
        };
        ElementLayout {
            dome_radius: radius,
            elements: self.places.iter().map(element).collect(),
        }
    }

    /// Normal and shear stiffness of the gel under one marker (N/m), for a contact of `radius` (m).
    pub fn stiffness(&self, radius: f64) -> [f64; 2] {
        let area = (self.gel.spacing / PX_PER_M).powi(2);
        self.layer
            .stiffness(1.0 / radius)
            .map(|per_area| per_area * area)
    }

    /// Image positions of the markers without contact (px).
    pub fn untouched(&self) -> Vec<DVec2> {
        let places = self.places.iter().zip(&self.off);
        places
            .map(|(place, off)| seen(&self.gel, *place, 0.0) + *off)
            .collect()
    }

    /// Returns the displacement of each marker from its untouched position (px), `interval` (s) after the previous
    /// frame, under `forces` (N) in the convention of [`TactileFrame`](feeler::sensor::forces::TactileFrame).
    pub fn displaced(&mut self, forces: &[DVec3], interval: f64, random: &mut Pcg64) -> Vec<DVec2> {
        let loads: Vec<_> = (self.places.iter().zip(forces))
            .filter(|(_, force)| **force != DVec3::ZERO)
            .collect();
        let part = -(-interval / self.gel.creep_time).exp_m1();
        let noise = self.gel.noise;
        let moved: Vec<_> = (self.places.iter())
            .map(|at| {
                let moved = |(from, force): &(&DVec2, &DVec3)| {
                    self.layer.displacement(**from, *at, **force)
                };
                loads.iter().map(moved).sum::<DVec3>()
            })
            .collect();
        let each = self.crept.iter_mut().zip(moved);
        let moved: Vec<_> = each
            .map(|(crept, moved)| {
                *crept += part * (self.gel.creep * moved - *crept);
                moved + *crept
            })
            .collect();
        (self.places.iter().zip(moved))
            .map(|(place, moved)| {
                let place_now = seen(&self.gel, *place + moved.truncate(), moved.z);
                let noise = DVec2::new(normal(random, noise), normal(random, noise));
                place_now - seen(&self.gel, *place, 0.0) + noise
            })
            .collect()
    }
}

fn size() -> DVec2 {
    DVec2::new(PICTURE.0 as f64, PICTURE.1 as f64)
}

/// Image position (px) of a point of the gel that is displaced inward by `sunk` (m).
fn seen(gel: &Gel, point: DVec2, sunk: f64) -> DVec2 {
    // An inward displacement moves the point closer to the camera.
    let near = point * gel.camera / (gel.camera - sunk);
    let far = (2.0 / FIELD * near).length_squared();
    size() / 2.0 + PX_PER_M * near * (1.0 + gel.distortion * far)
}
