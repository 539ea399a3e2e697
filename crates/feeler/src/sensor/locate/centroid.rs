//! A spot measured by its own pixels: centroid, size, contrast, and whether the picture's border cuts it.

use super::{quantile, reference::ReferencePicture, spots::Spot};
use crate::sensor::least_squares::outer;
use glam::{DMat3, DVec2, DVec3};
use std::f64::consts::PI;

/// Parts of a spot's contrast between which a pixel counts in proportion: below the lower one it is ground, which may slope; above
/// the upper one it is spot, whatever shines in it.
const COUNTED: (f64, f64) = (0.2, 0.9);

/// Part of a spot's contrast up to which a pixel about it is ground.
const GROUND: f64 = 0.3;

/// What the pixels about a spot say of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Measured {
    /// Column and row of its centroid, px.
    pub centre: DVec2,
    /// Diameter of the disc of the same area at half contrast, px.
    pub diameter: f64,
    /// Grey levels that it rises above the ground about it.
    pub contrast: f64,
    /// Whether it reaches the picture's border.
    pub cut: bool,
}

/// Distance from a spot's centre within which other spots matter to [`measure`], px.
pub(super) fn surroundings(spot: &Spot) -> f64 {
    let radius = 0.5 * spot.diameter;
    2.0 * (reach(radius) + radius)
}

/// Distance from a spot's centre up to which its pixels and the ground about it are measured, px.
fn reach(radius: f64) -> f64 {
    2.0 * radius + 1.0
}

/// Measures `spot`, beside which there are `others`, by those pixels about it that are nearer to it than to any of them.
pub(super) fn measure(picture: &ReferencePicture, spot: &Spot, others: &[DVec2]) -> Measured {
    let radius = 0.5 * spot.diameter;
    let reach = reach(radius);
    let others: Vec<DVec2> = others
        .iter()
        .copied()
        .filter(|other| (0.1..surroundings(spot)).contains(&other.distance(spot.centre)))
        .collect();
    let mut measured = Measured {
        centre: spot.centre,
        diameter: spot.diameter,
        contrast: spot.response,
        cut: false,
    };
    // The window follows the centroid.
    for _ in 0..3 {
        let pixels = Window::new(picture, measured.centre, reach, &others);
        let Some(next) = pixels.measure(radius) else {
            return measured;
        };
        let moved = next.centre.distance(measured.centre);
        if next.centre.distance(spot.centre) > radius {
            return measured;
        }
        measured = next;
        if moved < 0.01 {
            break;
        }
    }
    measured
}

/// The pixels about a place.
struct Window {
    about: DVec2,
    size: DVec2,
    /// Offset from `about` and grey level.
    pixels: Vec<(DVec2, f64)>,
}

impl Window {
    fn new(picture: &ReferencePicture, about: DVec2, reach: f64, others: &[DVec2]) -> Self {
        let (columns, rows) =
            super::regions::bounding_box((picture.width, picture.height), about, reach);
        let mut pixels = Vec::with_capacity(columns.len() * rows.len());
        for row in rows {
            for column in columns.clone() {
                let offset = DVec2::new(column as f64, row as f64) - about;
                let nearer = |other: &DVec2| {
                    (about + offset).distance_squared(*other) < offset.length_squared()
                };
                if offset.length_squared() <= reach * reach && !others.iter().any(nearer) {
                    let gray = picture.gray[row * picture.width + column];
                    pixels.push((offset, f64::from(gray)));
                }
            }
        }
        let size = DVec2::new(picture.width as f64, picture.height as f64);
        Self {
            about,
            size,
            pixels,
        }
    }

    fn measure(&self, radius: f64) -> Option<Measured> {
        let mut inner = self.grays(|distance| distance <= (0.6 * radius).max(0.8));
        let mut outer = self.grays(|distance| distance >= 1.3 * radius);
        if outer.len() < 8 {
            outer = self.grays(|_| true);
        }
        // Reflections in a dark spot are taken for darker than they are by no more than a tenth of its pixels.
        let (peak, level) = (quantile(&mut inner, 0.9), quantile(&mut outer, 0.5));
        if peak <= level {
            return None;
        }
        let is_ground = |distance: f64, gray: f64| {
            distance >= 1.3 * radius && gray < level + GROUND * (peak - level)
        };
        let ground = self.plane(is_ground).unwrap_or(DVec3::new(level, 0.0, 0.0));
        let contrast = peak - ground.x;
        if contrast <= 0.0 {
            return None;
        }
        let (mut sum, mut area, mut cut) = (DVec2::ZERO, 0.0, false);
        for &(offset, gray) in &self.pixels {
            let part = (gray - ground.dot(DVec3::new(1.0, offset.x, offset.y))) / contrast;
            let counted = (part.clamp(COUNTED.0, COUNTED.1) - COUNTED.0) / (COUNTED.1 - COUNTED.0);
            sum += counted * offset;
            area += counted;
            cut |= part > 0.6 && self.at_border(offset);
        }
        (area > 0.0).then(|| Measured {
            centre: self.about + sum / area,
            diameter: 2.0 * (area / PI).sqrt(),
            contrast,
            cut,
        })
    }

    /// The plane through the ground's grey levels by least squares: level under the window's centre, slopes along columns and rows.
    fn plane(&self, is_ground: impl Fn(f64, f64) -> bool) -> Option<DVec3> {
        let (mut normal, mut right, mut count) = (DMat3::ZERO, DVec3::ZERO, 0);
        for &(offset, gray) in self
            .pixels
            .iter()
            .filter(|(o, gray)| is_ground(o.length(), *gray))
        {
            let row = DVec3::new(1.0, offset.x, offset.y);
            normal += outer(row);
            right += gray * row;
            count += 1;
        }
        // Fewer pixels, or all on one side, would tilt the plane by chance.
        (count >= 12 && normal.determinant() > 1e-3 * normal.x_axis.x.powi(3))
            .then(|| normal.inverse() * right)
    }

    fn grays(&self, wanted: impl Fn(f64) -> bool) -> Vec<f64> {
        let pixels = self.pixels.iter();
        pixels
            .filter(|(offset, _)| wanted(offset.length()))
            .map(|&(_, gray)| gray)
            .collect()
    }

    fn at_border(&self, offset: DVec2) -> bool {
        let place = self.about + offset;
        place.min_element() < 0.5 || (self.size - 1.0 - place).min_element() < 0.5
    }
}
