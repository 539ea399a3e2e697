//! Total forces on a fingertip, from images or taxel readings in arrays.

use crate::errors::refused;
use crate::interrupt::interruptible;
use crate::layout::Layout;
use feeler::sensor::forces::{ElementReading, SensingChain, SensingError};
use feeler::sensor::image::Picture;
use feeler::sensor::wrench::taxels::{TaxelCalibration, TaxelWrenchEstimator};
use feeler::sensor::wrench::{self as core, WrenchCalibration, WrenchEstimate};
use feeler_lab::sensor::SensorGeometry;
use glam::DVec3;
use numpy::{
    PyArray1, PyArray2, PyArrayMethods as _, PyReadonlyArray1, PyReadonlyArray3,
    PyUntypedArrayMethods as _,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// Components [N, 8], validity [N] and novelty [N] of wrenches.
type Wrenches<'py> = (
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray1<f64>>,
);

/// Estimator of the total force on one fingertip.
#[pyclass(frozen, module = "feeler._core")]
pub struct WrenchEstimator {
    kind: Kind,
}

enum Kind {
    Images(Box<(SensingChain, core::WrenchEstimator)>),
    Taxels(Box<TaxelWrenchEstimator>),
}

#[pymethods]
impl WrenchEstimator {
    /// Creates the estimator of the calibration in `text` (TOML). A camera's calibration requires a `layout` or an
    /// `experiment`.
    #[new]
    fn new(
        text: &str,
        layout: Option<PyRef<'_, Layout>>,
        experiment: Option<&str>,
        finger: Option<usize>,
    ) -> PyResult<Self> {
        let kind = if TaxelCalibration::is_kind(text) {
            let calibration = TaxelCalibration::from_toml(text).map_err(refused)?;
            let estimator = TaxelWrenchEstimator::new(calibration).map_err(refused)?;
            Kind::Taxels(Box::new(estimator))
        } else {
            camera_sensor(text, layout.as_deref(), experiment, finger)?
        };
        Ok(Self { kind })
    }

    #[getter]
    fn element_count(&self) -> usize {
        match &self.kind {
            Kind::Images(sensor) => sensor.1.element_count(),
            Kind::Taxels(estimator) => estimator.calibration().made_for.elements,
        }
    }

    /// Width and height of the images, px; `None` for taxels.
    #[getter]
    fn picture_size(&self) -> Option<(usize, usize)> {
        match &self.kind {
            Kind::Images(sensor) => Some(sensor.0.picture_size()),
            Kind::Taxels(_) => None,
        }
    }

    /// Estimates the wrench in each of `frames` [N, H, W].
    fn estimate<'py>(
        &self,
        py: Python<'py>,
        frames: PyReadonlyArray3<'_, u8>,
    ) -> PyResult<Wrenches<'py>> {
        let Kind::Images(sensor) = &self.kind else {
            return Err(PyValueError::new_err(
                "expected a calibration of a camera's sensor, got one of a taxel array; call estimate_taxels",
            ));
        };
        let (mut chain, mut estimator) = (**sensor).clone();
        let (width, height) = chain.picture_size();
        let pixels = frames.as_slice()?;
        let sense = |stop: &AtomicBool| {
            let mut readings = vec![ElementReading::default(); chain.element_count()];
            let pictures = pixels.chunks_exact((width * height).max(1));
            let pictures = pictures.take_while(|_| !stop.load(Ordering::Relaxed));
            let estimates = pictures.map(|pixels| {
                let picture = Picture {
                    width,
                    height,
                    pixels,
                };
                chain.sense(&picture, &mut readings)?;
                Ok(estimator.estimate(&readings))
            });
            estimates.collect::<Result<Vec<_>, SensingError>>()
        };
        let estimates = interruptible(py, sense, |_| Ok(()))?;
        arrays(py, &estimates.map_err(refused)?)
    }

    /// Estimates the wrench for each row of `readings` [N, E, 3] at `stamps` [N], s. The rows are one sequence that
    /// begins without load.
    fn estimate_taxels<'py>(
        &self,
        py: Python<'py>,
        readings: PyReadonlyArray3<'_, f64>,
        stamps: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<Wrenches<'py>> {
        let Kind::Taxels(estimator) = &self.kind else {
            return Err(PyValueError::new_err(
                "expected a calibration of a taxel array, got one of a camera's sensor; call estimate",
            ));
        };
        let mut estimator = estimator.clone();
        estimator.restart();
        let elements = readings.shape()[1];
        let (readings, stamps) = (readings.as_slice()?, stamps.as_slice()?);
        let estimate = |stop: &AtomicBool| {
            let rows = readings.chunks_exact((3 * elements).max(1)).zip(stamps);
            let rows = rows.take_while(|_| !stop.load(Ordering::Relaxed));
            let estimates = rows.map(|(row, &stamp)| {
                let values: Vec<_> = row.chunks_exact(3).map(DVec3::from_slice).collect();
                estimator.estimate(stamp, &values)
            });
            estimates.collect::<Vec<_>>()
        };
        let estimates = interruptible(py, estimate, |_| Ok(()))?;
        arrays(py, &estimates)
    }
}

/// Creates the estimator of a camera's sensor.
fn camera_sensor(
    text: &str,
    layout: Option<&Layout>,
    experiment: Option<&str>,
    finger: Option<usize>,
) -> PyResult<Kind> {
    let geometry = match (layout, experiment) {
        (Some(layout), _) => SensorGeometry::of_layout(&layout.layout),
        (None, Some(name)) => SensorGeometry::of_experiment(name, finger),
        (None, None) => {
            return Err(PyValueError::new_err(
                "the calibration is of a camera's sensor; pass its layout or experiment, as in layout=\"my.layout.toml\"",
            ));
        }
    };
    let mut geometry = geometry.map_err(refused)?;
    let calibration = geometry.parse_wrench_calibration(text).map_err(refused)?;
    let calibration: WrenchCalibration = calibration.ok_or_else(|| {
        PyValueError::new_err("expected a calibration by `feeler calibrate --wrench`")
    })?;
    let chain = geometry.sensing_chain().map_err(refused)?;
    let estimator = core::WrenchEstimator::new(calibration).map_err(refused)?;
    Ok(Kind::Images(Box::new((chain, estimator))))
}

/// Converts estimates to arrays; unknown components are NaN.
fn arrays<'py>(py: Python<'py>, estimates: &[WrenchEstimate]) -> PyResult<Wrenches<'py>> {
    let components = estimates.iter().flat_map(|estimate| estimate.components);
    let components = components.map(|component| component.unwrap_or(f64::NAN));
    let axes = core::AXES;
    Ok((
        PyArray1::from_iter(py, components).reshape([estimates.len(), axes])?,
        PyArray1::from_iter(py, estimates.iter().map(|estimate| estimate.valid)),
        PyArray1::from_iter(py, estimates.iter().map(|estimate| estimate.novelty)),
    ))
}
