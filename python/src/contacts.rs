//! Contacts of forces in arrays.

use feeler::sensor::contact::{Contact, ContactEstimator};
use feeler::sensor::fingertip::SensingElement;
use glam::{DMat3, DVec3};
use numpy::{PyArray2, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods as _};
use pyo3::prelude::*;

/// Contact in each frame of `force` [N, E, 3] on elements at `tips` [E, 3] with `rotations` [E, 3, 3] to `T`: touching,
/// centre (3), its error, normal (3), force (3), its error, torsion, its error, semi-axes (2), their errors (2),
/// direction (3), friction and sliding [N, 23]. Unknown values are NaN.
#[pyfunction]
pub fn estimate_contacts<'py>(
    py: Python<'py>,
    force: PyReadonlyArray3<'py, f64>,
    tips: PyReadonlyArray2<'py, f64>,
    rotations: PyReadonlyArray3<'py, f64>,
    touch: f64,
    friction: Option<f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let elements = force.shape()[1];
    let places = tips
        .as_slice()?
        .chunks_exact(3)
        .zip(rotations.as_slice()?.chunks_exact(9));
    let places = places.map(|(tip, rows)| {
        let rotation = DMat3::from_cols_slice(rows).transpose();
        (SensingElement { ring: 0, rotation }, DVec3::from_slice(tip))
    });
    let mut estimator = ContactEstimator::new(places, touch);
    if let Some(friction) = friction {
        estimator = estimator.with_friction(friction);
    }
    let forces = force.as_slice()?;
    let rows: Vec<_> = py.detach(|| {
        let frames = forces.chunks_exact((3 * elements).max(1));
        let frames = frames.map(|frame| {
            let forces: Vec<_> = frame.chunks_exact(3).map(DVec3::from_slice).collect();
            row(estimator.estimate(&forces).as_ref())
        });
        frames.collect()
    });
    Ok(PyArray2::from_vec2(py, &rows)?)
}

fn row(contact: Option<&Contact>) -> Vec<f64> {
    let Some(c) = contact else {
        let unknown = std::iter::repeat_n(f64::NAN, 22);
        return std::iter::once(0.0).chain(unknown).collect();
    };
    let ellipse = c.ellipse;
    let unknown = f64::NAN;
    let mut row = vec![c.touching as f64];
    row.extend(c.centre.to_array());
    row.push(c.centre_error);
    row.extend(c.normal.to_array());
    row.extend(c.force.to_array());
    row.extend([c.force_error, c.torsion, c.torsion_error]);
    row.extend(ellipse.map_or([unknown; 2], |e| e.semi_axes));
    row.extend(ellipse.map_or([unknown; 2], |e| e.errors));
    row.extend(ellipse.map_or([unknown; 3], |e| e.direction.to_array()));
    row.push(c.friction.unwrap_or(unknown));
    row.push(c.sliding_share().unwrap_or(unknown));
    row
}
