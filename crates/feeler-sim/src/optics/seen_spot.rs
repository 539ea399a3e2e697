//! Spots as the camera sees them, and the light that they add to pixels.

use crate::optics_model::{OpticsModel, Spot};
use glam::Vec3;
use std::ops::Range;

/// Pixels that are lit side by side: a row of a spot is as many times as many, the last of them beyond its reach.
pub(super) const SIDE_BY_SIDE: usize = 8;

/// A spot as the camera sees it: a disc on the dome whose edge falls off linearly over twice the
/// blur. Its height is such that the light of the disc, the area of the contact, is kept however
/// small it is.
#[derive(Debug, Clone)]
pub(super) struct SeenSpot {
    /// m, in `T`.
    centre: Vec3,
    profile: SpotProfile,
    pub rows: Range<usize>,
    pub columns: Range<usize>,
}

impl SeenSpot {
    /// The spot of an element; none where the cone does not touch or the camera does not see it.
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
        // Casts to usize saturate at 0, so that a box beyond the picture is empty.
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

    /// Adds its light in one row of the picture.
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

/// Columns in whole steps of [`SIDE_BY_SIDE`], where `width` has room for that, that hold those from `first` on before `last`.
pub(super) fn side_by_side(first: usize, last: usize, width: usize) -> Range<usize> {
    let (first, last) = (first.min(width), last.min(width));
    let count = last.saturating_sub(first).next_multiple_of(SIDE_BY_SIDE);
    let count = count.min(width);
    let start = first.min(width - count);
    start..start + count
}

/// Brightness of a spot over the distance from its centre.
#[derive(Debug, Clone, Copy)]
struct SpotProfile {
    reach: f32,
    slope: f32,
    height: f32,
}

impl SpotProfile {
    /// For a spot of `radius` whose edge is blurred by `blur` to both sides, m, `contrast` times as bright as others.
    fn new(radius: f64, blur: f64, contrast: f64) -> Self {
        // Light of the unscaled profile over pi: a cone with its top cut off, or a whole cone.
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
    use crate::optics_config::OpticsConfig;
    use feeler::sensor::fingertip::{Fingertip, FingertipConfig};
    use glam::DVec3;

    /// A pixel's distance to a spot's centre is that of the dome's points, which no box knows of.
    #[test]
    fn a_spot_reaches_no_pixel_outside_of_its_box() {
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
            let seen = |spot| SeenSpot::new(&model, element, spot);
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
