//! Checks that the signs of a calibration's forces match the images.

use super::element::ElementCalibration;
use super::error::CalibrationError;
use super::relative_moments::RelativeMoments;
use glam::DVec2;

/// Minimum fraction of elements with reversed forces for the loads to be rejected; in single elements, noise may be the
/// cause.
const SYSTEMATIC: f64 = 0.9;

/// Function that returns `true` if a component of an element's force is reversed.
type IsReversed = fn(&ElementCalibration) -> bool;

/// Rejects a calibration that gives tension for compressed elements, or shear opposite to the displacement, which
/// results from loads with reversed signs.
pub fn check_signs(elements: &[ElementCalibration]) -> Result<(), CalibrationError> {
    let columns: [(_, IsReversed); 3] = [
        ("f_x", |element| shear_slope(element, DVec2::X) < 0.0),
        ("f_y", |element| shear_slope(element, DVec2::Y) < 0.0),
        ("f_z", is_tension),
    ];
    for (force, is_reversed) in columns.into_iter().rev() {
        let reversed = elements
            .iter()
            .filter(|&element| is_reversed(element))
            .count();
        let elements = elements.len();
        if reversed > 0 && reversed as f64 >= SYSTEMATIC * elements as f64 {
            return Err(CalibrationError::Reversed {
                force,
                reversed,
                elements,
            });
        }
    }
    Ok(())
}

/// Returns whether `F_z` decreases with gray-value growth and is negative on average. This is not the case for a sensor
/// that darkens under compression.
fn is_tension(element: &ElementCalibration) -> bool {
    let [range, ..] = element.map.ranges();
    let [low, high] = range.map(|growth| {
        let displacement = DVec2::ZERO;
        element
            .map
            .force(RelativeMoments {
                growth,
                displacement,
            })
            .z
    });
    high < low && high + low < 0.0
}

/// Change of the shear force along `axis` (N) from the smallest to the largest displacement along it, at half of the
/// maximum gray-value growth, because an element under load has grown.
fn shear_slope(element: &ElementCalibration, axis: DVec2) -> f64 {
    let [[_, growth], along_x, along_y] = element.map.ranges();
    let range = if axis == DVec2::X { along_x } else { along_y };
    let [low, high] = range.map(|displacement| {
        let inputs = RelativeMoments {
            growth: 0.5 * growth,
            displacement: displacement * axis,
        };
        element.map.force(inputs).truncate().dot(axis)
    });
    high - low
}
