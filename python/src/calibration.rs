//! Calibrations: parsing, and fitting to loads.

use crate::errors::{failed, refused};
use crate::interrupt::interruptible;
use crate::layout::Layout;
use feeler::sensor::calibration::{
    self as core, CalibrationReport, ELEMENT_RANGE, ElementRecord, ForceAxes, FullScale,
    ModelChoice, RecordBuilder, check_axes, check_magnitude, check_numbers, fit,
};
use feeler::sensor::image::Picture;
use feeler::sensor::moments::ElementMoments;
use feeler_lab::config::Experiment;
use feeler_lab::sensor::{LoadsFile, SensorGeometry};
use feeler_sim::bench::{CalibrationBenchConfig, CalibrationBenchError, take_pictures};
use glam::DVec3;
use numpy::{
    IntoPyArray as _, PyArray3, PyArrayMethods as _, PyReadonlyArray3, PyUntypedArrayMethods as _,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

/// Calibration of one fingertip: function from moments to forces.
#[pyclass(frozen, module = "feeler._core")]
pub struct Calibration(pub core::Calibration);

#[pymethods]
impl Calibration {
    /// Parses a calibration (TOML).
    #[staticmethod]
    fn parse(text: &str) -> PyResult<Self> {
        Ok(Self(core::Calibration::from_toml(text).map_err(refused)?))
    }

    fn to_toml(&self) -> PyResult<String> {
        self.0.to_toml().map_err(failed)
    }

    #[getter]
    fn element_count(&self) -> usize {
        self.0.elements.len()
    }

    #[getter]
    fn model(&self) -> &'static str {
        match self.0.model() {
            core::CalibrationModel::Separable => "separable",
            core::CalibrationModel::Coupled => "coupled",
        }
    }

    /// Root mean square error on held-out loads along x, y and z of each element, N [E, 3].
    fn held_out_rms(&self) -> Vec<[f64; 3]> {
        let elements = self.0.elements.iter();
        elements
            .map(|e| e.quality.held_out.rms.to_array())
            .collect()
    }

    /// Returns the errors of the calibration as text.
    fn report(&self) -> String {
        CalibrationReport::new(&self.0).to_string()
    }
}

/// Sensor, model and full scale to fit.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Fit<'py> {
    layout: Option<PyRef<'py, Layout>>,
    experiment: String,
    finger: Option<usize>,
    model: String,
    full_scale_normal: Option<f64>,
    full_scale_shear: Option<f64>,
}

impl Fit<'_> {
    fn geometry(&self) -> PyResult<SensorGeometry> {
        let geometry = match &self.layout {
            Some(layout) => SensorGeometry::of_layout(&layout.layout),
            None => SensorGeometry::of_experiment(&self.experiment, self.finger),
        };
        geometry.map_err(refused)
    }

    fn fit(
        &self,
        py: Python<'_>,
        geometry: SensorGeometry,
        records: &[ElementRecord],
    ) -> PyResult<Calibration> {
        let choice = match self.model.as_str() {
            "separable" => ModelChoice::Separable,
            "coupled" => ModelChoice::Coupled,
            "auto" => ModelChoice::Auto,
            other => {
                return Err(PyValueError::new_err(format!(
                    "model = {other:?}: expected \"separable\", \"coupled\" or \"auto\""
                )));
            }
        };
        let largest = FullScale::of_loads(records);
        let full_scale = FullScale {
            normal: self.full_scale_normal.unwrap_or(largest.normal),
            shear: self.full_scale_shear.unwrap_or(largest.shear),
        };
        let fit = |_: &_| fit(geometry.made_for, records, choice, full_scale);
        let fitted = interruptible(py, fit, |_| Ok(()))?;
        let calibration = fitted.map_err(refused)?;
        calibration.check_magnitude().map_err(refused)?;
        Ok(Calibration(calibration))
    }
}

/// Fits a calibration to the loads in the CSV file at `path`.
#[pyfunction]
pub fn calibrate_file(py: Python<'_>, path: PathBuf, how: Fit<'_>) -> PyResult<Calibration> {
    let geometry = how.geometry()?;
    let loads = LoadsFile::read(&path, &geometry.seen, ForceAxes::default()).map_err(refused)?;
    loads.check_magnitude().map_err(refused)?;
    let measure = |_: &_| {
        let measured = loads.measure(&geometry, || {})?;
        loads.check(&measured).map(|()| measured)
    };
    let measured = interruptible(py, measure, |_| Ok(()))?.map_err(refused)?;
    let calibration = how.fit(py, geometry, &measured.records())?;
    let checked = loads.check_fit(&measured, &calibration.0);
    checked.map_err(refused).map(|_| calibration)
}

/// Fits a calibration to `frames` [N, H, W] under `forces` [N, E, 3], N; NaN for unknown forces.
#[pyfunction]
pub fn calibrate_frames(
    py: Python<'_>,
    frames: PyReadonlyArray3<'_, u8>,
    forces: PyReadonlyArray3<'_, f64>,
    how: Fit<'_>,
) -> PyResult<Calibration> {
    let geometry = how.geometry()?;
    let elements = geometry.kernel.element_count();
    let ((width, height), count) = (geometry.size, frames.shape()[0]);
    if frames.shape() != [count, height, width] || forces.shape() != [count, elements, 3] {
        return Err(PyValueError::new_err(format!(
            "expected frames [N, {height}, {width}] and forces [N, {elements}, 3], got {:?} and {:?}",
            frames.shape(),
            forces.shape()
        )));
    }
    let mut builder = RecordBuilder::new(elements);
    let mut moments = vec![ElementMoments::default(); elements];
    let pictures = frames.as_slice()?.chunks_exact(width * height);
    let loads = forces.as_slice()?.chunks_exact(3 * elements);
    for (pixels, loads) in pictures.zip(loads) {
        let picture = Picture {
            width,
            height,
            pixels,
        };
        let measured = geometry.kernel.measure(&picture, &mut moments);
        measured.map_err(refused)?;
        let known = |load: &[f64]| Some(DVec3::from_slice(load)).filter(|load| !load.is_nan());
        let loads: Vec<_> = loads.chunks_exact(3).map(known).collect();
        builder.add(&loads, &moments);
    }
    let pictures = builder.pictures();
    let forces = pictures.iter().flat_map(|picture| &picture.forces);
    let forces = forces.copied().flatten();
    check_magnitude("an element", forces, ELEMENT_RANGE).map_err(refused)?;
    let records = builder.records();
    let check = |_: &_| check_numbers(pictures).and_then(|()| check_axes(&records));
    interruptible(py, check, |_| Ok(()))?.map_err(refused)?;
    how.fit(py, geometry, &records)
}

/// Reason why no further images are accepted.
enum Taken {
    Interrupted,
    Failed(CalibrationBenchError),
}

impl From<CalibrationBenchError> for Taken {
    fn from(error: CalibrationBenchError) -> Self {
        Self::Failed(error)
    }
}

/// Returns images of the simulated fingertip of `experiment` [N, H, W] with their loads [N, E, 3], N.
#[pyfunction]
#[pyo3(signature = (experiment, finger, combined, seed))]
pub fn simulate_loads<'py>(
    py: Python<'py>,
    experiment: &str,
    finger: Option<usize>,
    combined: usize,
    seed: u64,
) -> PyResult<(Bound<'py, PyArray3<u8>>, Bound<'py, PyArray3<f64>>)> {
    let experiment = Experiment::load(experiment, &[]).map_err(refused)?;
    let fingertip = experiment.fingertip(finger).map_err(refused)?;
    let optics = &experiment.config.simulation().map_err(refused)?.optics;
    let bench = CalibrationBenchConfig {
        seed,
        ..CalibrationBenchConfig::of_fingertip(fingertip, optics, combined)
    };
    let (mut pixels, mut forces, mut count) = (Vec::new(), Vec::new(), 0);
    let take = |stop: &AtomicBool| {
        let taken = take_pictures(fingertip, optics, &bench, |picture, loads| {
            if stop.load(Ordering::Relaxed) {
                return Err(Taken::Interrupted);
            }
            pixels.extend_from_slice(&picture.pixels);
            forces.extend(loads.iter().flat_map(|load| load.force().to_array()));
            count += 1;
            Ok(())
        });
        match taken {
            Ok(()) | Err(Taken::Interrupted) => Ok(()),
            Err(Taken::Failed(error)) => Err(error),
        }
    };
    interruptible(py, take, |_| Ok(()))?.map_err(refused)?;
    let (width, height) = (fingertip.camera.width, fingertip.camera.height);
    let elements = fingertip.layout.element_count();
    let frames = pixels.into_pyarray(py).reshape([count, height, width])?;
    Ok((
        frames,
        forces.into_pyarray(py).reshape([count, elements, 3])?,
    ))
}
