//! Flags computed from arrays of forces.

use feeler::control::{FlagAnalyzer, FlagThresholds};
use feeler::sensor::forces::TactileFrame;
use glam::DVec3;
use numpy::{
    PyReadonlyArray1, PyReadonlyArray3, PyReadwriteArray1, PyReadwriteArray2,
    PyUntypedArrayMethods as _,
};
use pyo3::prelude::*;

/// Output arrays: shear rate [N, E], TOUCH, SLIP, OVER and grasp force [N].
#[derive(FromPyObject)]
pub struct Flags<'py>(
    PyReadwriteArray2<'py, f64>,
    PyReadwriteArray1<'py, bool>,
    PyReadwriteArray1<'py, bool>,
    PyReadwriteArray1<'py, bool>,
    PyReadwriteArray1<'py, f64>,
);

/// Computes shear rate, TOUCH, SLIP, OVER and grasp force from `force` [N, E, 3] at `stamps` [N] with the thresholds
/// F1, F2 and dr.
#[pyfunction]
pub fn raise_flags(
    force: PyReadonlyArray3<'_, f64>,
    stamps: PyReadonlyArray1<'_, f64>,
    thresholds: (f64, f64, f64),
    flags: Flags<'_>,
) -> PyResult<()> {
    let elements = force.shape()[1];
    let (touch_force, over_force, slip_threshold) = thresholds;
    let thresholds = FlagThresholds {
        touch_force,
        over_force,
        slip_threshold,
    };
    let mut analyzer = FlagAnalyzer::new(thresholds, elements);
    let mut frame = TactileFrame::unloaded(elements);
    let Flags(mut shear_rate, mut touch, mut slip, mut over, mut grasp_force) = flags;
    let (touch, slip) = (touch.as_slice_mut()?, slip.as_slice_mut()?);
    let (over, grasp_force) = (over.as_slice_mut()?, grasp_force.as_slice_mut()?);
    let frames = force.as_slice()?.chunks_exact((3 * elements).max(1));
    let rates = shear_rate.as_slice_mut()?.chunks_exact_mut(elements.max(1));
    let frames = frames.zip(rates).zip(stamps.as_slice()?).zip(touch);
    let frames = frames.zip(slip).zip(over).zip(grasp_force).enumerate();
    for (index, ((((((forces, rates), &stamp), touch), slip), over), grasp_force)) in frames {
        frame.sequence = index as u64;
        frame.stamp = stamp;
        for (force, components) in frame.forces.iter_mut().zip(forces.chunks_exact(3)) {
            *force = DVec3::from_slice(components);
        }
        let flags = analyzer.analyze(&frame);
        rates.copy_from_slice(analyzer.shear_rate());
        (*touch, *slip, *over) = (flags.touch, flags.slip, flags.over);
        *grasp_force = flags.grasp_force;
    }
    Ok(())
}
