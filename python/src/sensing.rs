//! Computes arrays of moments and forces from arrays of frames.

use crate::calibration::Calibration;
use crate::errors::refused;
use crate::interrupt::interruptible;
use crate::layout::Layout;
use crate::places::Places;
use feeler::sensor::forces::{DriftConfig, ElementReading, Reference, SensingChain, SensingError};
use feeler::sensor::image::{Exposure, Picture};
use feeler_lab::config::Experiment;
use feeler_lab::sensor::SensorGeometry;
use glam::DVec2;
use numpy::{
    PyArray1, PyArray2, PyArray3, PyArrayMethods as _, PyReadonlyArray3, PyReadwriteArray2,
    PyReadwriteArray3, PyUntypedArrayMethods as _,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;

/// Number of frames that a thread processes at a time, which takes some milliseconds.
const CHUNK: usize = 64;
/// Number of frames below which sensing is faster than the reaction to a signal.
const SHORT: usize = 256;

/// Sensing chain of one fingertip: from frames to moments and forces.
#[pyclass(frozen, module = "feeler._core")]
pub struct Sensor {
    /// Idle chains. Their number is the maximum number of threads that have used this sensor at once.
    chains: Mutex<Vec<SensingChain>>,
    /// Template of new chains.
    template: SensingChain,
    /// `true` if results depend on the preceding frames.
    in_order: bool,
    places: Places,
    /// Reference of the displacements, or `None` if none was set.
    reference: Option<Reference>,
}

#[pymethods]
impl Sensor {
    /// Creates the sensor of `calibration`; without one, that of `layout` or of the experiment's fingertip.
    #[new]
    #[pyo3(signature = (calibration, layout, experiment, finger, drift_correction, max_saturated))]
    fn new(
        calibration: Option<&Calibration>,
        layout: Option<&Layout>,
        experiment: Option<&str>,
        finger: Option<usize>,
        drift_correction: bool,
        max_saturated: Option<f64>,
    ) -> PyResult<Self> {
        let (geometry, places) = geometry(calibration, layout, experiment, finger)?;
        let SensorGeometry {
            size,
            kernel,
            regions,
            max_saturated: usual,
            made_for,
            ..
        } = geometry;
        let max_saturated = max_saturated.unwrap_or(usual);
        let chain = SensingChain::new(size, kernel, &regions, max_saturated);
        let mut chain = chain.map_err(refused)?;
        if let Some(Calibration(calibration)) = calibration {
            made_for
                .verify_same(&calibration.made_for)
                .map_err(refused)?;
            chain = chain
                .with_calibration(calibration.clone())
                .map_err(refused)?;
        }
        if drift_correction {
            chain = chain.with_drift_correction(DriftConfig::default());
        }
        Ok(Self {
            chains: Mutex::new(vec![chain.clone()]),
            template: chain,
            in_order: drift_correction,
            places,
            reference: None,
        })
    }

    #[getter]
    fn element_count(&self) -> usize {
        self.template.element_count()
    }

    /// Width and height of the frames, px.
    #[getter]
    fn picture_size(&self) -> (usize, usize) {
        self.template.picture_size()
    }

    #[getter]
    fn is_calibrated(&self) -> bool {
        self.template.is_calibrated()
    }

    /// Column and row of each element's centre, px [E, 2].
    fn centres<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let centres = self.places.centres.iter().map(|c| c.to_array().to_vec());
        Ok(PyArray2::from_vec2(py, &centres.collect::<Vec<_>>())?)
    }

    /// Tip of each unloaded feeler, m, in `T` [E, 3], or `None` if the dome is not known.
    fn tips<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let Some(elements) = &self.places.on_dome else {
            return Ok(None);
        };
        let tips = elements.iter().map(|e| e.tip.to_array().to_vec());
        Ok(Some(PyArray2::from_vec2(py, &tips.collect::<Vec<_>>())?))
    }

    /// Rotation from each element's frame `E_i` to `T` [E, 3, 3], or `None` if the dome is not known.
    fn rotations<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray3<f64>>>> {
        let Some(elements) = &self.places.on_dome else {
            return Ok(None);
        };
        let rows = elements
            .iter()
            .flat_map(|e| e.rotation.transpose().to_cols_array());
        let flat = PyArray1::from_iter(py, rows);
        Ok(Some(flat.reshape([elements.len(), 3, 3])?))
    }

    /// Returns a copy of the sensor whose displacements are relative to the mean centroids in `frames` [N, H, W].
    fn with_reference(&self, frames: PyReadonlyArray3<'_, u8>) -> PyResult<Self> {
        let frames = Frames::of(&frames, self.picture_size())?;
        let mut chain = self.template.clone();
        let mut readings = Vec::with_capacity(frames.count());
        for frame in frames.pixels.chunks_exact(frames.length) {
            let mut sensed = vec![ElementReading::default(); chain.element_count()];
            let picture = frames.picture(frame);
            chain.sense(&picture, &mut sensed).map_err(refused)?;
            readings.push(sensed);
        }
        self.counting_from(Reference::from_readings(readings.iter().map(Vec::as_slice)))
    }

    /// Column and row of each element's reference centroid, or `None` if no reference was set. The entry of an
    /// element that was dark is `None`.
    fn reference(&self) -> Option<Vec<Option<(f64, f64)>>> {
        let centroids = self.reference.as_ref()?.centroids.iter();
        Some(centroids.map(|c| c.map(|c| (c.x, c.y))).collect())
    }

    /// Returns a copy of the sensor whose displacements are relative to these centroids.
    fn with_reference_at(&self, centroids: Vec<Option<(f64, f64)>>) -> PyResult<Self> {
        let centroids = centroids.into_iter();
        self.counting_from(Reference {
            centroids: centroids.map(|c| c.map(DVec2::from)).collect(),
        })
    }

    /// Fills `force` [N, E, 3], `valid` [N, E], `gray` [N, E] and `displacement` [N, E, 2] from `frames` [N, H, W],
    /// on up to `threads` threads.
    fn sense(
        &self,
        py: Python<'_>,
        frames: PyReadonlyArray3<'_, u8>,
        mut force: PyReadwriteArray3<'_, f64>,
        mut valid: PyReadwriteArray2<'_, bool>,
        mut gray: PyReadwriteArray2<'_, f64>,
        mut displacement: PyReadwriteArray3<'_, f64>,
        threads: usize,
    ) -> PyResult<()> {
        let frames = Frames::of(&frames, self.picture_size())?;
        let (count, elements) = (frames.count(), self.element_count());
        let shapes = [
            (force.shape() == [count, elements, 3]),
            (valid.shape() == [count, elements]),
            (gray.shape() == [count, elements]),
            (displacement.shape() == [count, elements, 2]),
        ];
        if shapes.contains(&false) {
            return Err(PyValueError::new_err(format!(
                "expected outputs for {count} frames of {elements} elements, got {:?}",
                force.shape()
            )));
        }
        let work = Chunks {
            frames: frames.pixels.chunks(CHUNK * frames.length),
            force: force.as_slice_mut()?.chunks_mut(CHUNK * elements * 3),
            valid: valid.as_slice_mut()?.chunks_mut(CHUNK * elements),
            gray: gray.as_slice_mut()?.chunks_mut(CHUNK * elements),
            displacement: displacement
                .as_slice_mut()?
                .chunks_mut(CHUNK * elements * 2),
        };
        let threads = if self.in_order { 1 } else { threads };
        let sense = |stop: &AtomicBool| self.sense_on(threads, &frames, work, stop);
        let sensed = if count < SHORT && threads == 1 {
            py.detach(|| sense(&AtomicBool::new(false)))
        } else {
            interruptible(py, sense, |_| Ok(()))?
        };
        sensed.map_err(refused)
    }
}

impl Sensor {
    fn counting_from(&self, reference: Reference) -> PyResult<Self> {
        let mut chain = self.template.clone();
        chain.set_reference(reference.clone()).map_err(refused)?;
        Ok(Self {
            chains: Mutex::new(vec![chain.clone()]),
            template: chain,
            in_order: self.in_order,
            places: self.places.clone(),
            reference: Some(reference),
        })
    }

    fn sense_on(
        &self,
        threads: usize,
        frames: &Frames<'_>,
        work: Chunks<'_>,
        stop: &AtomicBool,
    ) -> Result<(), SensingError> {
        let work = Mutex::new(work);
        let next = || lock(&work).next().filter(|_| !stop.load(Ordering::Relaxed));
        let sense = || {
            let mut chain = self.take_chain();
            let mut readings = vec![ElementReading::default(); chain.element_count()];
            let mut sensed = Ok(());
            while let (Ok(()), Some(chunk)) = (&sensed, next()) {
                sensed = chunk.sense(frames, &mut chain, &mut readings);
            }
            lock(&self.chains).push(chain);
            sensed
        };
        thread::scope(|scope| {
            let others: Vec<_> = (1..threads).map(|_| scope.spawn(sense)).collect();
            let own = sense();
            others.into_iter().fold(own, |sensed, other| {
                let other = other
                    .join()
                    .unwrap_or_else(|panic| std::panic::resume_unwind(panic));
                sensed.and(other)
            })
        })
    }

    fn take_chain(&self) -> SensingChain {
        let chain = lock(&self.chains).pop();
        chain.unwrap_or_else(|| self.template.clone())
    }
}

/// Locks a mutex, even after a panic of another thread: the protected data remain consistent.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn geometry(
    calibration: Option<&Calibration>,
    layout: Option<&Layout>,
    experiment: Option<&str>,
    finger: Option<usize>,
) -> PyResult<(SensorGeometry, Places)> {
    if let Some(Layout { layout, .. }) = layout {
        let geometry = SensorGeometry::of_layout(layout).map_err(refused)?;
        return Ok((geometry, Places::of_layout(layout)));
    }
    let fingertip = calibration.and_then(|Calibration(c)| c.made_for.fingertip.as_ref());
    let loaded = experiment
        .map(|name| Experiment::load(name, &[]))
        .transpose();
    let loaded = loaded.map_err(refused)?;
    let config = match (&loaded, fingertip) {
        (Some(experiment), _) => experiment.fingertip(finger).map_err(refused)?,
        (None, Some(fingertip)) => fingertip,
        (None, None) => {
            return Err(PyValueError::new_err(
                "the calibration was made for a located layout; pass that layout, as in layout=\"my.layout.toml\"",
            ));
        }
    };
    let geometry = SensorGeometry::of_fingertip(config).map_err(refused)?;
    Ok((geometry, Places::of_fingertip(config)?))
}

/// Contiguous frames in memory.
struct Frames<'a> {
    width: usize,
    height: usize,
    /// Number of pixels of one frame.
    length: usize,
    pixels: &'a [u8],
}

impl<'a> Frames<'a> {
    fn of(array: &'a PyReadonlyArray3<'_, u8>, (width, height): (usize, usize)) -> PyResult<Self> {
        let shape = array.shape();
        if shape[1..] != [height, width] {
            return Err(PyValueError::new_err(format!(
                "expected frames of {height} rows and {width} columns, got {} and {}",
                shape[1], shape[2]
            )));
        }
        Ok(Self {
            width,
            height,
            length: width * height,
            pixels: array.as_slice()?,
        })
    }

    fn count(&self) -> usize {
        self.pixels.len() / self.length.max(1)
    }

    fn picture(&self, pixels: &'a [u8]) -> Picture<&'a [u8]> {
        Picture {
            width: self.width,
            height: self.height,
            pixels,
        }
    }
}

/// Remaining work: frames and output slices.
struct Chunks<'a> {
    frames: std::slice::Chunks<'a, u8>,
    force: std::slice::ChunksMut<'a, f64>,
    valid: std::slice::ChunksMut<'a, bool>,
    gray: std::slice::ChunksMut<'a, f64>,
    displacement: std::slice::ChunksMut<'a, f64>,
}

impl<'a> Chunks<'a> {
    fn next(&mut self) -> Option<Chunk<'a>> {
        Some(Chunk {
            frames: self.frames.next()?,
            force: self.force.next()?,
            valid: self.valid.next()?,
            gray: self.gray.next()?,
            displacement: self.displacement.next()?,
        })
    }
}

/// A batch of frames and its output slices.
struct Chunk<'a> {
    frames: &'a [u8],
    force: &'a mut [f64],
    valid: &'a mut [bool],
    gray: &'a mut [f64],
    displacement: &'a mut [f64],
}

impl Chunk<'_> {
    fn sense(
        self,
        frames: &Frames<'_>,
        chain: &mut SensingChain,
        readings: &mut [ElementReading],
    ) -> Result<(), SensingError> {
        let elements = readings.len();
        let pictures = self.frames.chunks_exact(frames.length);
        let following = self.frames.chunks_exact(frames.length).skip(1);
        let pictures = pictures.zip(following.chain([&[][..]]));
        let outputs = self.force.chunks_exact_mut(3 * elements);
        let outputs = outputs.zip(self.valid.chunks_exact_mut(elements));
        let outputs = outputs.zip(self.gray.chunks_exact_mut(elements));
        let outputs = outputs.zip(self.displacement.chunks_exact_mut(2 * elements));
        for ((pixels, next), (((force, valid), gray), displacement)) in pictures.zip(outputs) {
            let picture = Picture {
                width: frames.width,
                height: frames.height,
                pixels,
            };
            chain.sense_with_prefetch(&picture, next, readings)?;
            let outputs = force.chunks_exact_mut(3).zip(valid).zip(gray);
            let outputs = outputs.zip(displacement.chunks_exact_mut(2));
            for (reading, (((force, valid), gray), moved)) in readings.iter().zip(outputs) {
                let none = [f64::NAN; 3];
                force.copy_from_slice(&reading.force.map_or(none, |force| force.to_array()));
                *valid = match chain.is_calibrated() {
                    true => reading.force.is_some(),
                    false => reading.exposure == Exposure::Good,
                };
                *gray = reading.integrated_gray;
                let displacement = reading.displacement;
                moved.copy_from_slice(&displacement.map_or([f64::NAN; 2], |u| u.to_array()));
            }
        }
        Ok(())
    }
}
