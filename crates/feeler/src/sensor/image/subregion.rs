//! Assignment of pixels to elements.

use crate::math::direction_at;
use crate::sensor::fingertip::dome::DomeProjection;
use crate::sensor::fingertip::layout::{ElementLayout, SensingElement};
use crate::sensor::moments::config::{MomentsConfig, MomentsError};
use glam::DVec2;
use std::{f64::consts::TAU, ops::Range};

/// A pixel of a sub-region with its area and position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeightedPixel {
    /// Column in the image.
    pub column: usize,
    /// Row in the image.
    pub row: usize,
    /// Area `w` covered by the pixel in the element's tangent plane, m² (or px² in the image plane).
    pub area: f64,
    /// Position of the pixel in that plane, m (or px).
    pub point: DVec2,
}

/// Computes the [`subregion`] of every element of `layout`.
///
/// # Errors
/// If a sub-region is not completely within the image, or its radius is out of range.
pub fn subregions(
    layout: &ElementLayout,
    projection: &DomeProjection,
    config: &MomentsConfig,
) -> Result<Vec<Vec<WeightedPixel>>, MomentsError> {
    let radius = config.subregion_radius;
    if !(radius > 0.0 && radius < layout.dome_radius) {
        return Err(MomentsError::Radius {
            radius,
            dome_radius: layout.dome_radius,
        });
    }
    (0..layout.elements.len())
        .map(|element| subregion(layout, projection, element, radius))
        .collect()
}

/// Pixels within `radius` (m) of the axis of `element` and nearer to it than to any other element, dewarped and sorted
/// by row and then by column.
///
/// # Errors
/// If the sub-region is not completely within the image.
pub fn subregion(
    layout: &ElementLayout,
    projection: &DomeProjection,
    element: usize,
    radius: f64,
) -> Result<Vec<WeightedPixel>, MomentsError> {
    let (columns, rows) = bounding_box(layout, projection, element, radius)?;
    let pixels = rows.flat_map(|row| columns.clone().map(move |column| (column, row)));
    let own = pixels.filter_map(|(column, row)| {
        let pixel = DVec2::new(column as f64, row as f64);
        let (area, point) = own_pixel(layout, projection, element, radius, pixel)?;
        Some(WeightedPixel {
            column,
            row,
            area,
            point,
        })
    });
    Ok(own.collect())
}

/// Area and position of a pixel in the tangent plane of `element`; `None` if it does not belong to that element.
fn own_pixel(
    layout: &ElementLayout,
    projection: &DomeProjection,
    element: usize,
    radius: f64,
    pixel: DVec2,
) -> Option<(f64, DVec2)> {
    let own = &layout.elements[element];
    let point = projection.point_at(pixel)?;
    let nearness = point.dot(own.normal());
    let nearer = |(other, e): (usize, &SensingElement)| {
        let nearness_of_other = point.dot(e.normal());
        nearness_of_other > nearness || (nearness_of_other == nearness && other < element)
    };
    if nearness <= 0.0 || layout.elements.iter().enumerate().any(nearer) {
        return None;
    }
    let dewarped = projection.dewarp(pixel, own)?;
    (dewarped.point.length() <= radius).then_some((dewarped.area, dewarped.point))
}

/// Columns and rows that contain the sub-region of `element`, computed from the projection of its rim.
fn bounding_box(
    layout: &ElementLayout,
    projection: &DomeProjection,
    element: usize,
    radius: f64,
) -> Result<(Range<usize>, Range<usize>), MomentsError> {
    let (width, height) = (projection.width(), projection.height());
    let out_of_picture = |seen_at: String| MomentsError::OutOfPicture {
        element,
        seen_at,
        width,
        height,
    };
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for step in 0..64 {
        let rim = radius * direction_at(TAU * f64::from(step) / 64.0);
        let pixel = projection
            .lift(rim, &layout.elements[element])
            .and_then(|point| projection.project(point))
            .ok_or_else(|| out_of_picture("points outside the camera's field of view".into()))?;
        let inside = pixel.x >= 0.0
            && pixel.y >= 0.0
            && pixel.x <= (width - 1) as f64
            && pixel.y <= (height - 1) as f64;
        if !inside {
            let (column, row) = (pixel.x, pixel.y);
            return Err(out_of_picture(format!("column {column:.1}, row {row:.1}")));
        }
        low = low.min(pixel);
        high = high.max(pixel);
    }
    // One pixel of margin for the arc between two points of the rim.
    let range = |low: f64, high: f64, end: usize| {
        (low.floor() as usize).saturating_sub(1)..(high.ceil() as usize + 2).min(end)
    };
    Ok((range(low.x, high.x, width), range(low.y, high.y, height)))
}
