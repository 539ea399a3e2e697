//! Measures a spot from its pixels: centroid, diameter, contrast, and whether it is cut by the image border.

use super::{quantile, reference::ReferencePicture, spot::Spot};
use crate::sensor::calibration::least_squares::outer;
use glam::{DMat3, DVec2, DVec3};
use std::f64::consts::PI;

/// Pixel weights rise linearly from 0 to 1 between these fractions of a spot's contrast. Below the first, a pixel is
/// background, which may be sloped; above the second it belongs to the spot fully, despite highlights.
const COUNTED: (f64, f64) = (0.2, 0.9);

/// Maximum gray level of background pixels around a spot, as a fraction of its contrast.
const GROUND: f64 = 0.3;

/// Properties of a spot measured from its pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Measured {
    /// Column and row of the centroid, px.
    pub centre: DVec2,
    /// Diameter of the disc with the same weighted area as the spot, px.
    pub diameter: f64,
    /// Gray levels of the spot above the local background.
    pub contrast: f64,
    /// `true` if the spot reaches the image border.
    pub cut: bool,
}

/// Distance from a spot's centre within which other spots affect [`measure`], px.
pub(super) fn surroundings(spot: &Spot) -> f64 {
    let radius = 0.5 * spot.diameter;
    2.0 * (reach(radius) + radius)
}

/// Radius of the window in which a spot and its background are measured, px.
fn reach(radius: f64) -> f64 {
    2.0 * radius + 1.0
}

/// Measures `spot` from the pixels around it that are closer to it than to any of the `others`.
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
    // Recentre the window on the centroid.
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

/// The pixels around a point.
struct Window {
    about: DVec2,
    size: DVec2,
    /// Offset from `about` and gray level of each pixel.
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
        // The 0.9 quantile ignores highlights, which make up to a tenth of a dark spot's pixels look too strong.
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

    /// Fits a plane to the background pixels by least squares. Returns the level at the window's centre and the slopes
    /// along columns and rows.
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
        // Too few pixels, or pixels on one side only, would give a random tilt.
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
