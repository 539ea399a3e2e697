//! Whether a calibration's forces point the way that pictures do.

use super::calibration::{CalibrationError, ElementCalibration, Inputs};
use glam::DVec2;

/// Part of the elements in which forces must be reversed for loads to have been: of single elements, noise may be the reason.
const SYSTEMATIC: f64 = 0.9;

/// Whether a component of an element's force is reversed.
type IsReversed = fn(&ElementCalibration) -> bool;

/// Refuses a calibration that reports tension where elements are pressed, or shear against the displacement, as one that was fitted to
/// loads of reversed signs does.
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

/// Whether `F_z` falls with growth, down to more tension than there is compression: a sensor that dims under compression has none.
fn is_tension(element: &ElementCalibration) -> bool {
    let [range, ..] = element.map.ranges();
    let [low, high] = range.map(|growth| {
        let displacement = DVec2::ZERO;
        element
            .map
            .force(Inputs {
                growth,
                displacement,
            })
            .z
    });
    high < low && high + low < 0.0
}

/// By how much the shear along `axis` rises from the least to the greatest displacement along it, N, at half of the growth: without any,
/// there is no load.
fn shear_slope(element: &ElementCalibration, axis: DVec2) -> f64 {
    let [[_, growth], along_x, along_y] = element.map.ranges();
    let range = if axis == DVec2::X { along_x } else { along_y };
    let [low, high] = range.map(|displacement| {
        let inputs = Inputs {
            growth: 0.5 * growth,
            displacement: displacement * axis,
        };
        element.map.force(inputs).truncate().dot(axis)
    });
    high - low
}
