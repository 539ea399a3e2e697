//! Checks the signs and axes of forces against the moments in the images.

use super::{COLUMNS, CapturedImage, LoadCheckError, named, unloaded_mean};
use crate::sensor::calibration::fit::ElementRecord;
use crate::sensor::calibration::live::ForceAxes;
use crate::sensor::calibration::loads::records;
use crate::sensor::calibration::relative_moments::RelativeMoments;
use crate::sensor::wrench::recordings::recordings;
use glam::{DMat3, DVec3};
use std::collections::BTreeMap;

/// Minimum number of loads for an element to be checked.
const MIN_LOADS: usize = 8;
/// Minimum determinant of the correlation matrix of `f_x`, `f_y` and `f_z`; below it, their effects cannot be
/// separated.
const MIN_DETERMINANT: f64 = 0.05;
/// Minimum fraction of the variance of each input (gray-value growth, displacements) that the forces must explain.
const MIN_EXPLAINED: f64 = 0.5;
/// Minimum margin by which other axes must explain the images better than the given axes, in standardized effects.
const DECISIVE: f64 = 0.5;

/// Force column and its sign (`true` if negated) for each of x, y and z, estimated from the images.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct SeenAxes([(usize, bool); 3]);

/// All permutations of three columns.
const ORDERS: [[usize; 3]; 6] = [
    [0, 1, 2],
    [1, 0, 2],
    [2, 1, 0],
    [0, 2, 1],
    [1, 2, 0],
    [2, 0, 1],
];

impl SeenAxes {
    /// Axes as given in the table.
    const GIVEN: Self = Self([(0, false), (1, false), (2, false)]);

    fn is_reordered(self) -> bool {
        self.0
            .iter()
            .zip(0..)
            .any(|(&(column, _), axis)| column != axis)
    }

    /// Mapping from the given forces to forces with the estimated axes.
    fn converting(self) -> ForceAxes {
        ForceAxes::of_rows(self.0.map(|(column, is_negative)| {
            let axis = [DVec3::X, DVec3::Y, DVec3::Z][column];
            if is_negative { -axis } else { axis }
        }))
    }

    /// Describes the error in the columns and its likely cause.
    fn what(self, f_z_is_negative: bool) -> String {
        if self.is_reordered() {
            let [x, y, z] = self.0.map(|(column, is_negative)| {
                let sign = if is_negative { "-" } else { "" };
                format!("{sign}{}", COLUMNS[column])
            });
            return format!(
                "the displacement of the spots along x and y and their growth follow {x}, {y} and {z}; expected f_x, f_y and f_z: are \
                 axes exchanged?"
            );
        }
        let is_negative = self.0.map(|(_, is_negative)| is_negative);
        let shear = match is_negative {
            [true, true, _] => "f_x and f_y",
            [true, false, _] => "f_x",
            _ => "f_y",
        };
        match (is_negative, f_z_is_negative) {
            ([true, true, true], true) => "the spots grow where f_z is negative, and move against f_x and f_y; expected forces on the \
                                           finger: do these act on the object?"
                .into(),
            ([false, false, true], true) => "the spots grow where f_z is negative; expected compression, which is positive when \
                                             pressed: does z point out of the finger?"
                .into(),
            ([_, _, true], false) => "the spots shrink where f_z is positive; expected spots that grow when pressed: is f_z a tension, \
                                      or are bright and dark exchanged in the layout?"
                .into(),
            ([_, _, is_tension], _) => format!(
                "the spots move against {shear}{}; expected x and y as in the layout: is an axis mirrored, as up instead of down in the \
                 picture, or do the forces act on the object?",
                if is_tension { ", and grow where f_z is negative" } else { "" }
            ),
        }
    }
}

/// Rejects loads whose signs or axes contradict the images of any element whose images determine them.
///
/// Gray-value growth and displacement are regressed on the three forces. The axes that explain them best must be the
/// given axes.
///
/// # Errors
/// Returns [`LoadCheckError::Axes`] with the columns, the number of elements and the likely cause.
pub fn check_axes(records: &[ElementRecord]) -> Result<(), LoadCheckError> {
    let seen: Vec<_> = records
        .iter()
        .enumerate()
        .filter_map(|(element, record)| Some((element, seen_axes(record)?)))
        .collect();
    let mut by_axes: BTreeMap<SeenAxes, Vec<usize>> = BTreeMap::new();
    for &(element, axes) in &seen {
        by_axes.entry(axes).or_default().push(element);
    }
    by_axes.remove(&SeenAxes::GIVEN);
    let Some((&axes, elements)) = by_axes.iter().max_by_key(|(_, elements)| elements.len()) else {
        return Ok(());
    };
    let forces = elements
        .iter()
        .flat_map(|&element| &records[element].fitted);
    let f_z_is_negative = forces.map(|sample| sample.force.z).sum::<f64>() < 0.0;
    let (contradicted, judged) = (elements.len(), seen.len());
    Err(LoadCheckError::Axes {
        recording: None,
        contradicted,
        judged,
        first: elements[0],
        what: match 2 * contradicted > judged {
            true => axes.what(f_z_is_negative),
            false => {
                axes.what(f_z_is_negative)
                    + " Or do the numbers of these elements differ from the layout, or are their forces in other axes (x_angle)?"
            }
        },
        axes: (2 * contradicted > judged).then(|| Box::new(axes.converting())),
    })
}

/// Like [`check_axes`], but also checks each recording separately; recordings are distinguished by the `names` of the
/// images. If axes are exchanged in one of several recordings, all loads together may determine no axes.
///
/// # Errors
/// Returns [`LoadCheckError::Axes`] with the columns, the number of elements, the likely cause and, if only one
/// recording is affected, its name.
pub fn check_axes_of_recordings<'a>(
    pictures: &[CapturedImage],
    names: impl Iterator<Item = &'a str>,
) -> Result<(), LoadCheckError> {
    let all = records(pictures);
    let together = check_axes(&all);
    if let Err(LoadCheckError::Axes { axes: Some(_), .. }) = together {
        return together;
    }
    let (recordings, of) = recordings(names);
    if recordings.len() < 2 {
        return together;
    }
    for (number, recording) in recordings.iter().enumerate() {
        let own = pictures
            .iter()
            .zip(&of)
            .filter(|(_, (of, _))| *of == number);
        let mut own = records(own.map(|(picture, _)| picture));
        for (own, all) in own.iter_mut().zip(&all) {
            if own.unloaded.is_empty() {
                own.unloaded.clone_from(&all.unloaded);
            }
        }
        check_axes(&own).map_err(|error| error.of_recording(named(recording)))?;
    }
    together
}

/// Axes estimated from an element's images, or `None` if the images do not determine them.
fn seen_axes(record: &ElementRecord) -> Option<SeenAxes> {
    let unloaded = unloaded_mean(record.unloaded.iter())?;
    let loads: Vec<_> = record
        .fitted
        .iter()
        .map(|sample| {
            let RelativeMoments {
                growth,
                displacement,
            } = RelativeMoments::relative(
                &sample.moments,
                unloaded.integrated_gray,
                unloaded.centroid,
            );
            (sample.force, displacement.extend(growth))
        })
        .collect();
    if loads.len() < MIN_LOADS
        || !loads
            .iter()
            .all(|(force, input)| force.is_finite() && input.is_finite())
    {
        return None;
    }
    let (effects, explained) = effects(&loads)?;
    // For each input (displacements, growth), the column that has the largest effect on it.
    let total = |order: [usize; 3]| {
        (0..3)
            .map(|axis| effects.row(axis)[order[axis]].abs())
            .sum::<f64>()
    };
    let order = ORDERS
        .into_iter()
        .max_by(|&a, &b| total(a).total_cmp(&total(b)))?;
    let axes = SeenAxes([0, 1, 2].map(|axis| (order[axis], effects.row(axis)[order[axis]] < 0.0)));
    let given: f64 = (0..3).map(|axis| effects.row(axis)[axis]).sum();
    let differs = |axis: usize| axes.0[axis] != SeenAxes::GIVEN.0[axis];
    let is_known = (0..3).all(|axis| !differs(axis) || explained[axis] > MIN_EXPLAINED);
    match axes {
        SeenAxes::GIVEN => Some(axes),
        _ if is_known && total(order) - given > DECISIVE => Some(axes),
        _ => None,
    }
}

/// Least-squares effects of the forces (columns) on the inputs (rows), in standard deviations, and the explained
/// fraction of each input's variance. `None` if the forces do not vary independently.
fn effects(loads: &[(DVec3, DVec3)]) -> Option<(DMat3, DVec3)> {
    let mean_square = |of: &dyn Fn(&(DVec3, DVec3)) -> DVec3| {
        let sum: DVec3 = loads.iter().map(|load| of(load) * of(load)).sum();
        sum / loads.len() as f64
    };
    let scales = [mean_square(&|load| load.0), mean_square(&|load| load.1)]
        .map(|square| DVec3::from_array(square.to_array().map(f64::sqrt)));
    let [force_scale, input_scale] = scales;
    if !(force_scale.cmpgt(DVec3::ZERO).all() && input_scale.cmpgt(DVec3::ZERO).all()) {
        return None;
    }
    let outer = |a: DVec3, b: DVec3| DMat3::from_cols(a * b.x, a * b.y, a * b.z);
    let (mut of_forces, mut of_both) = (DMat3::ZERO, DMat3::ZERO);
    for &(force, input) in loads {
        let (force, input) = (force / force_scale, input / input_scale);
        of_forces += outer(force, force);
        of_both += outer(input, force);
    }
    let count = loads.len() as f64;
    let (of_forces, of_both) = (of_forces * (1.0 / count), of_both * (1.0 / count));
    if of_forces.determinant() < MIN_DETERMINANT {
        return None;
    }
    let effects = of_both * of_forces.inverse();
    // The mean squares of the inputs are 1.
    let explained =
        DVec3::from_array([0, 1, 2].map(|axis| effects.row(axis).dot(of_both.row(axis))));
    Some((effects, explained))
}
