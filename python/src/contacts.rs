//! Estimates contacts from arrays of forces.

use feeler::sensor::contact::{Contact, ContactEstimator};
use feeler::sensor::fingertip::SensingElement;
use glam::{DMat3, DVec3};
use numpy::{
    PyArray1, PyArrayMethods as _, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods as _,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Name of an array, number of its values per frame, and a function that returns these values of a contact; missing
/// ones are NaN.
type Field = (&'static str, usize, fn(&Contact) -> Vec<f64>);

const FIELDS: [Field; 14] = [
    ("touching", 1, |c| vec![c.touching as f64]),
    ("centre", 3, |c| c.centre.to_array().into()),
    ("centre_error", 1, |c| vec![c.centre_error]),
    ("normal", 3, |c| c.normal.to_array().into()),
    ("force", 3, |c| c.force.to_array().into()),
    ("force_error", 1, |c| vec![c.force_error]),
    ("torsion", 1, |c| vec![c.torsion]),
    ("torsion_error", 1, |c| vec![c.torsion_error]),
    ("semi_axes", 2, |c| {
        c.ellipse.map_or(vec![], |e| e.semi_axes.into())
    }),
    ("semi_axis_errors", 2, |c| {
        c.ellipse.map_or(vec![], |e| e.errors.into())
    }),
    ("direction", 3, |c| {
        c.ellipse.map_or(vec![], |e| e.direction.to_array().into())
    }),
    ("area_error", 1, |c| {
        c.ellipse.map(|e| e.area_error()).into_iter().collect()
    }),
    ("friction", 1, |c| c.friction.into_iter().collect()),
    ("sliding", 1, |c| c.sliding.into_iter().collect()),
];

/// Estimates the contact in each frame of `force` [N, E, 3] on elements at `tips` [E, 3] with `rotations` [E, 3, 3] to
/// `T`. Returns arrays by name, [N] or [N, width].
#[pyfunction]
pub fn estimate_contacts<'py>(
    py: Python<'py>,
    force: PyReadonlyArray3<'py, f64>,
    tips: PyReadonlyArray2<'py, f64>,
    rotations: PyReadonlyArray3<'py, f64>,
    touch: f64,
    friction: Option<f64>,
) -> PyResult<Bound<'py, PyDict>> {
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
    let contacts: Vec<_> = py.detach(|| {
        let frames = forces.chunks_exact((3 * elements).max(1));
        let frames = frames.map(|frame| {
            let forces: Vec<_> = frame.chunks_exact(3).map(DVec3::from_slice).collect();
            estimator.estimate(&forces)
        });
        frames.collect()
    });
    let arrays = PyDict::new(py);
    for (name, width, values) in FIELDS {
        let missing = std::iter::repeat(f64::NAN);
        let rows = contacts.iter().flat_map(|contact| {
            let values = contact.as_ref().map_or(vec![], values);
            values.into_iter().chain(missing.clone()).take(width)
        });
        let flat = PyArray1::from_iter(py, rows);
        match width {
            1 => arrays.set_item(name, flat)?,
            _ => arrays.set_item(name, flat.reshape([contacts.len(), width])?)?,
        }
    }
    Ok(arrays)
}
