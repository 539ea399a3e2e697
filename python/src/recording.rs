//! Recordings as columns, with one row per control step.

use crate::errors::refused;
use crate::interrupt::interruptible;
use feeler::hand::JointVector;
use feeler_record::reading::{PictureAt, PictureReader};
use feeler_record::wire::Vector3;
use feeler_record::{self as record, FingerStep, NO_ELEMENT, Step, Steps};
use glam::{DQuat, DVec3};
use numpy::{Element, IntoPyArray as _, PyArray1, PyArray3, PyArrayMethods as _};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::fs::File;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

/// Content of a recording.
#[pyclass(frozen, module = "feeler._core")]
pub struct Recording {
    recording: record::Recording,
    path: PathBuf,
    elements: usize,
    /// Columns by name.
    columns: Py<PyDict>,
}

#[pymethods]
impl Recording {
    /// Reads the recording at `path`, up to the first damaged part, if any.
    #[new]
    fn new(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let read = || {
            let recording = record::Recording::read(&path)?;
            let columns = Columns::of(&recording);
            Ok::<_, record::RecordError>((recording, columns))
        };
        let (recording, columns) = interruptible(py, |_| read(), |_| Ok(()))?.map_err(refused)?;
        Ok(Self {
            elements: columns.elements,
            columns: columns.into_dict(py)?.unbind(),
            recording,
            path,
        })
    }

    /// Columns by name.
    #[getter]
    fn columns<'py>(&self, py: Python<'py>) -> &Bound<'py, PyDict> {
        self.columns.bind(py)
    }

    /// The experiment of the run (TOML).
    #[getter]
    fn experiment(&self) -> &str {
        &self.recording.experiment
    }

    #[getter]
    fn digest(&self) -> String {
        self.recording.digest.to_string()
    }

    /// `True` if the recording is complete.
    #[getter]
    fn complete(&self) -> bool {
        self.recording.complete
    }

    /// Description of the damage, or `None` if the recording is complete.
    #[getter]
    fn problem(&self) -> Option<&str> {
        self.recording.problem.as_deref()
    }

    /// State in which the run ended, and the reason if it ended early.
    #[getter]
    fn end(&self) -> (String, Option<&str>) {
        let end = &self.recording.end;
        (end.state.to_string(), end.reason.as_deref())
    }

    #[getter]
    fn fingers(&self) -> usize {
        self.recording.fingers.len()
    }

    /// Maximum number of elements of a finger.
    #[getter]
    fn elements(&self) -> usize {
        self.elements
    }

    /// Number of recorded frames of `finger`.
    fn frame_count(&self, finger: usize) -> usize {
        let finger = self.recording.fingers.get(finger);
        finger.map_or(0, |finger| finger.pictures.len())
    }

    /// Returns the frames `start` to `stop` of `finger` [N, H, W], and their times [N], s.
    fn frames<'py>(
        &self,
        py: Python<'py>,
        finger: usize,
        start: usize,
        stop: usize,
    ) -> PyResult<(Bound<'py, PyArray3<u8>>, Bound<'py, PyArray1<f64>>)> {
        let pictures = self.recording.fingers.get(finger).map(|f| &f.pictures);
        let pictures = pictures.and_then(|pictures| pictures.get(start..stop));
        let pictures = pictures.unwrap_or_default();
        let read = |stop: &AtomicBool| self.read_pictures(pictures, stop);
        let (size, pixels) = interruptible(py, read, |_| Ok(()))?.map_err(PyOSError::new_err)?;
        let times = pictures.iter().map(|at| 1e-9 * at.log_time as f64);
        let shape = [pictures.len(), size.1, size.0];
        let frames = pixels.into_pyarray(py).reshape(shape)?;
        Ok((frames, PyArray1::from_iter(py, times)))
    }
}

impl Recording {
    /// Returns the width and height of `pictures`, and their concatenated pixels.
    fn read_pictures(
        &self,
        pictures: &[PictureAt],
        stop: &AtomicBool,
    ) -> Result<((usize, usize), Vec<u8>), String> {
        let file = File::open(&self.path).map_err(|e| format!("{}: {e}", self.path.display()))?;
        let mut reader = PictureReader::new(file);
        let (mut size, mut pixels) = (None, Vec::new());
        for at in pictures
            .iter()
            .take_while(|_| !stop.load(Ordering::Relaxed))
        {
            let picture = reader.read(*at)?;
            let (width, height) = *size.get_or_insert((picture.width, picture.height));
            if (picture.width, picture.height) != (width, height) {
                let (actual_width, actual_height) = (picture.width, picture.height);
                return Err(format!(
                    "expected frames of {width}x{height} px, got one of {actual_width}x{actual_height} px"
                ));
            }
            pixels.reserve_exact(picture.pixels.len() * pictures.len() - pixels.len());
            pixels.extend_from_slice(&picture.pixels);
        }
        Ok((size.unwrap_or((0, 0)), pixels))
    }
}

/// Values of all steps. Missing values are NaN, `False` or -1.
#[derive(Default)]
struct Columns {
    steps: usize,
    fingers: usize,
    /// Maximum number of elements of a finger.
    elements: usize,
    /// Maximum number of joints of a finger.
    joints: usize,
    time: Vec<f64>,
    phase: Vec<u8>,
    stroke: Vec<u32>,
    force: Vec<f64>,
    shear_rate: Vec<f64>,
    touch: Vec<bool>,
    slip: Vec<bool>,
    over: Vec<bool>,
    largest_element: Vec<i64>,
    grasp_force: Vec<f64>,
    joint_position: Vec<f64>,
    joint_velocity: Vec<f64>,
    joint_command: Vec<f64>,
    fingertip_command: Vec<f64>,
    limited: Vec<bool>,
    position: Vec<f64>,
    orientation: Vec<f64>,
    true_slip: Vec<f64>,
    torque: Vec<f64>,
    cap_angle: Vec<f64>,
    cap_torque: Vec<f64>,
    object_position: Vec<f64>,
    object_orientation: Vec<f64>,
}

impl Columns {
    fn of(recording: &record::Recording) -> Self {
        let frames = recording
            .fingers
            .iter()
            .flat_map(|finger| finger.tactile.first());
        let joints = recording.fingers.iter();
        let joints = joints.filter_map(|finger| Some(finger.joints.first()?.position.len()));
        let mut columns = Self {
            joints: joints.max().unwrap_or(3),
            fingers: recording.fingers.len(),
            elements: frames.map(|frame| frame.forces.len()).max().unwrap_or(0),
            ..Self::default()
        };
        for step in Steps::new(recording) {
            columns.push(&step);
        }
        columns
    }

    fn push(&mut self, step: &Step<'_>) {
        self.steps += 1;
        self.time.push(step.task.stamp);
        self.phase.push(step.task.phase.into());
        self.stroke.push(step.task.stroke);
        self.torque.push(step.torque.map_or(f64::NAN, |t| t.torque));
        self.cap_angle
            .push(step.cap.map_or(f64::NAN, |cap| cap.angle));
        let cap_torque = step.cap.map(|cap| cap.resisting_torque);
        self.cap_torque.push(cap_torque.unwrap_or(f64::NAN));
        let object = step.object;
        push(&mut self.object_position, object.map(|o| xyz(o.position)));
        push(
            &mut self.object_orientation,
            object.map(|o| DQuat::from(o.orientation).to_array()),
        );
        for (index, finger) in step.fingers.iter().enumerate() {
            let slip = step.true_slip.and_then(|slip| slip.distance.get(index));
            self.true_slip.push(slip.copied().unwrap_or(f64::NAN));
            self.push_finger(finger);
        }
    }

    fn push_finger(&mut self, finger: &FingerStep<'_>) {
        let forces = finger.tactile.map_or(&[][..], |tactile| &tactile.forces);
        let forces = forces.iter().map(|&force| xyz(force));
        let padded = forces.chain(std::iter::repeat([f64::NAN; 3]));
        self.force.extend(padded.take(self.elements).flatten());
        let flags = finger.flags;
        let rates = flags.map_or(&[][..], |flags| &flags.shear_rate);
        let padded = rates.iter().copied().chain(std::iter::repeat(f64::NAN));
        self.shear_rate.extend(padded.take(self.elements));
        self.touch.push(flags.is_some_and(|flags| flags.touch));
        self.slip.push(flags.is_some_and(|flags| flags.slip));
        self.over.push(flags.is_some_and(|flags| flags.over));
        let largest = flags.map(|flags| flags.largest_element);
        let largest = largest.filter(|&element| element != NO_ELEMENT);
        self.largest_element.push(largest.map_or(-1, i64::from));
        self.grasp_force
            .push(flags.map_or(f64::NAN, |flags| flags.grasp_force));
        let padded = |joints: Option<JointVector>| {
            let known = joints.into_iter().flatten();
            known.chain(std::iter::repeat(f64::NAN)).take(self.joints)
        };
        let joints = finger.joints;
        self.joint_position
            .extend(padded(joints.map(|j| j.position)));
        self.joint_velocity
            .extend(padded(joints.map(|j| j.velocity)));
        let command = finger.command;
        self.joint_command
            .extend(padded(command.map(|c| c.joint_velocity)));
        push(
            &mut self.fingertip_command,
            command.map(|c| xyz(c.fingertip_velocity)),
        );
        self.limited
            .push(command.is_some_and(|command| command.limited));
        push(
            &mut self.position,
            finger.fingertip.map(|f| xyz(f.position)),
        );
        push(
            &mut self.orientation,
            finger
                .fingertip
                .map(|f| DQuat::from(f.orientation).to_array()),
        );
    }

    fn into_dict(self, py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let columns = PyDict::new(py);
        let (n, f, e, j) = (self.steps, self.fingers, self.elements, self.joints);
        put(&columns, "time", self.time, &[n])?;
        put(&columns, "phase", self.phase, &[n])?;
        put(&columns, "stroke", self.stroke, &[n])?;
        put(&columns, "force", self.force, &[n, f, e, 3])?;
        put(&columns, "shear_rate", self.shear_rate, &[n, f, e])?;
        put(&columns, "touch", self.touch, &[n, f])?;
        put(&columns, "slip", self.slip, &[n, f])?;
        put(&columns, "over", self.over, &[n, f])?;
        put(&columns, "largest_element", self.largest_element, &[n, f])?;
        put(&columns, "grasp_force", self.grasp_force, &[n, f])?;
        put(&columns, "joint_position", self.joint_position, &[n, f, j])?;
        put(&columns, "joint_velocity", self.joint_velocity, &[n, f, j])?;
        put(&columns, "joint_command", self.joint_command, &[n, f, j])?;
        put(
            &columns,
            "fingertip_command",
            self.fingertip_command,
            &[n, f, 3],
        )?;
        put(&columns, "limited", self.limited, &[n, f])?;
        put(&columns, "position", self.position, &[n, f, 3])?;
        put(&columns, "orientation", self.orientation, &[n, f, 4])?;
        put(&columns, "true_slip", self.true_slip, &[n, f])?;
        put(&columns, "torque", self.torque, &[n])?;
        put(&columns, "cap_angle", self.cap_angle, &[n])?;
        put(&columns, "cap_torque", self.cap_torque, &[n])?;
        put(&columns, "object_position", self.object_position, &[n, 3])?;
        put(
            &columns,
            "object_orientation",
            self.object_orientation,
            &[n, 4],
        )?;
        Ok(columns)
    }
}

fn xyz(vector: Vector3) -> [f64; 3] {
    DVec3::from(vector).to_array()
}

fn push<const N: usize>(column: &mut Vec<f64>, numbers: Option<[f64; N]>) {
    column.extend(numbers.unwrap_or([f64::NAN; N]));
}

/// Adds a column as a read-only array.
fn put<T: Element>(
    columns: &Bound<'_, PyDict>,
    name: &str,
    numbers: Vec<T>,
    shape: &[usize],
) -> PyResult<()> {
    let array = numbers.into_pyarray(columns.py()).reshape(shape)?;
    array.getattr("flags")?.setattr("writeable", false)?;
    columns.set_item(name, array)
}
