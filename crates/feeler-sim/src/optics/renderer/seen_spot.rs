//! Projected spots, and the light that they add to pixels.

use crate::optics::model::OpticsModel;
use crate::optics::spot::Spot;
use glam::Vec3;
use std::ops::Range;

/// Number of pixels per vectorized step. The width of a spot's box is a multiple of it.
pub(super) const SIDE_BY_SIDE: usize = 8;

/// A spot in the image: a disc on the dome whose intensity falls linearly over twice the blur at the edge. Its height
/// is chosen such that the integrated light equals the contact's area, however small.
#[derive(Debug, Clone)]
pub(crate) struct ProjectedSpot {
    /// Centre in `T` (m).
    centre: Vec3,
    profile: SpotProfile,
    pub rows: Range<usize>,
    pub columns: Range<usize>,
}

impl ProjectedSpot {
    /// Projects a spot of an element. `None` if the cone does not touch or is not visible.
    pub fn new(model: &OpticsModel, element: usize, spot: &Spot) -> Option<Self> {
        if spot.radius <= 0.0 {
            return None;
        }
        let projection = &model.projection;
        let (largest_scale, mean_scale) = model.scales[element];
        let blur = model.config.blur_px / mean_scale;
        let reach = spot.radius + blur;
        let point = projection.lift(spot.centre, &model.layout.elements[element])?;
        let pixel = projection.project(point)?;
        let half_box = reach * largest_scale + 1.0;
        // Casts to usize saturate at 0, so a box outside the image is empty.
        let first = (pixel - half_box).floor();
        let last = (pixel + half_box).ceil() + 1.0;
        let (width, height) = (projection.width(), projection.height());
        Some(Self {
            centre: point.as_vec3(),
            profile: SpotProfile::new(spot.radius, blur, spot.contrast),
            rows: (first.y as usize).min(height)..(last.y as usize).min(height),
            columns: side_by_side(first.x as usize, last.x as usize, width),
        })
    }

    /// Adds the spot's light to one row of the image.
    #[inline(always)]
    pub fn light_row(&self, model: &OpticsModel, row: usize, lit: &mut [f32]) {
        let width = model.projection.width();
        let Range { start, end } = self.columns;
        let span = row * width + start..row * width + end;
        let [x, y, z] = &model.dome_points;
        let (Some(lit), Some(x), Some(y), Some(z)) = (
            lit.get_mut(start..end),
            x.get(span.clone()),
            y.get(span.clone()),
            z.get(span),
        ) else {
            return;
        };
        let centre = self.centre;
        for (((lit, x), y), z) in lit.iter_mut().zip(x).zip(y).zip(z) {
            let (dx, dy, dz) = (x - centre.x, y - centre.y, z - centre.z);
            *lit += self.profile.at((dx * dx + dy * dy + dz * dz).sqrt());
        }
    }
}

/// Columns that contain `first..last`, widened to a multiple of [`SIDE_BY_SIDE`] if `width` permits.
pub(crate) fn side_by_side(first: usize, last: usize, width: usize) -> Range<usize> {
    let (first, last) = (first.min(width), last.min(width));
    let count = last.saturating_sub(first).next_multiple_of(SIDE_BY_SIDE);
    let count = count.min(width);
    let start = first.min(width - count);
    start..start + count
}

/// Intensity of a spot as a function of the distance from its centre.
#[derive(Debug, Clone, Copy)]
struct SpotProfile {
    reach: f32,
    slope: f32,
    height: f32,
}

impl SpotProfile {
    /// Creates the profile of a spot of `radius` with its edge blurred by `blur` on both sides (m), scaled by
    /// `contrast`.
    fn new(radius: f64, blur: f64, contrast: f64) -> Self {
        // Integral of the unscaled profile over pi: a truncated or whole cone.
        let light = if radius >= blur {
            radius * radius + blur * blur / 3.0
        } else {
            (radius + blur).powi(3) / (6.0 * blur)
        };
        let height = radius * radius * contrast / light;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::config::OpticsConfig;
    use feeler::sensor::fingertip::{Fingertip, FingertipConfig};
    use glam::DVec3;

    /// Distances are measured between points of the dome, independently of the spot's box.
    #[test]
    fn a_spot_lights_no_pixel_outside_its_box() {
        let fingertip = Fingertip::new(&FingertipConfig::default()).expect("a fingertip");
        let (layout, projection) = (&fingertip.layout, &fingertip.projection);
        let optics = OpticsConfig::default();
        let model = OpticsModel::new(&optics, layout, projection).expect("a model");
        let width = projection.width();
        let loads = [
            [0.0, 0.0, 0.0],
            [0.0, 0.0, 2.0],
            [1.8, 0.0, 2.0],
            [-1.2, -1.3, 2.0],
        ];
        let mut lit = 0;
        for element in 0..layout.elements.len() {
            let spots = loads.map(|load| model.spots(DVec3::from_array(load)));
            let seen = |spot| ProjectedSpot::new(&model, element, spot);
            for spot in spots.as_flattened().iter().filter_map(seen) {
                let rows = spot.rows.start.saturating_sub(12)..spot.rows.end + 12;
                let columns = spot.columns.start.saturating_sub(12)..spot.columns.end + 12;
                for row in rows.start..rows.end.min(projection.height()) {
                    for column in columns.start..columns.end.min(width) {
                        let [x, y, z] = model
                            .dome_points
                            .each_ref()
                            .map(|p| p[row * width + column]);
                        let light = spot.profile.at(spot.centre.distance(Vec3::new(x, y, z)));
                        let inside = spot.rows.contains(&row) && spot.columns.contains(&column);
                        assert!(inside || light == 0.0, "{element}: {column}, {row}");
                        lit += usize::from(light > 0.0);
                    }
                }
            }
        }
        assert!(lit > 10_000, "{lit} pixels are lit");
    }
}
