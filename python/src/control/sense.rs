//! What a hand feels, and what a task wants of it, as Python sees both.

use feeler::control::phase::Phase;
use feeler::control::plan;
use feeler::control::sense;
use glam::DVec3;
use numpy::{PyArray1, PyArray2, PyArrayMethods as _};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// A number for each axis.
pub type Vector = [f64; 3];

/// What a task wants of a finger.
#[pyclass(frozen, from_py_object, module = "feeler._core")]
#[derive(Clone)]
pub struct Plan(pub plan::Plan);

#[pymethods]
impl Plan {
    #[new]
    #[pyo3(signature = (velocity, towards_object = [0.0; 3], *, reflex = false, keep_grasp = false))]
    fn new(velocity: Vector, towards_object: Vector, reflex: bool, keep_grasp: bool) -> Self {
        Self(plan::Plan {
            velocity: velocity.into(),
            towards_object: towards_object.into(),
            reflex,
            keep_grasp,
        })
    }

    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.0.velocity)
    }

    #[getter]
    fn towards_object<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.0.towards_object)
    }

    #[getter]
    fn reflex(&self) -> bool {
        self.0.reflex
    }

    #[getter]
    fn keep_grasp(&self) -> bool {
        self.0.keep_grasp
    }

    fn __repr__(&self) -> String {
        let plan::Plan {
            velocity,
            towards_object,
            reflex,
            keep_grasp,
        } = self.0;
        format!(
            "Plan(velocity={:?}, towards_object={:?}, reflex={}, keep_grasp={})",
            velocity.to_array(),
            towards_object.to_array(),
            python_bool(reflex),
            python_bool(keep_grasp)
        )
    }
}

/// What one finger feels, and where.
#[pyclass(frozen, module = "feeler._core")]
pub struct FingerSense {
    force: Vec<DVec3>,
    normals: Vec<DVec3>,
    shear_rate: Vec<f64>,
    flags: feeler::control::flags::FingerFlags,
    pose: sense::FingertipPose,
    joints: feeler::hand::JointState,
    resultant: DVec3,
}

impl FingerSense {
    /// A copy of what `finger` feels.
    pub fn of(finger: &sense::FingerSense<'_>) -> Self {
        let elements = 0..finger.touch.frame.forces.len();
        let normal = |element| finger.normal(element).unwrap_or(DVec3::NAN);
        Self {
            force: finger.touch.frame.forces.clone(),
            normals: elements.map(normal).collect(),
            shear_rate: finger.touch.shear_rate.clone(),
            flags: *finger.flags(),
            pose: finger.pose,
            joints: finger.joints,
            resultant: finger.resultant(),
        }
    }
}

#[pymethods]
impl FingerSense {
    #[getter]
    fn force<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, &self.force)
    }

    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, &self.normals)
    }

    #[getter]
    fn shear_rate<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.shear_rate)
    }

    #[getter]
    fn touch(&self) -> bool {
        self.flags.touch
    }

    #[getter]
    fn slip(&self) -> bool {
        self.flags.slip
    }

    #[getter]
    fn over(&self) -> bool {
        self.flags.over
    }

    #[getter]
    fn largest_element(&self) -> Option<usize> {
        self.flags.largest_element
    }

    #[getter]
    fn grasp_force(&self) -> f64 {
        self.flags.grasp_force
    }

    #[getter]
    fn position<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.pose.position)
    }

    #[getter]
    fn rotation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows_of = self.pose.rotation.transpose();
        rows(py, &[rows_of.x_axis, rows_of.y_axis, rows_of.z_axis])
    }

    #[getter]
    fn joint_position<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.joints.position)
    }

    #[getter]
    fn joint_velocity<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.joints.velocity)
    }

    #[getter]
    fn resultant<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.resultant)
    }

    fn __repr__(&self) -> String {
        format!(
            "FingerSense({} elements, grasp_force={:.3} N, touch={}, slip={}, over={})",
            self.force.len(),
            self.flags.grasp_force,
            python_bool(self.flags.touch),
            python_bool(self.flags.slip),
            python_bool(self.flags.over)
        )
    }
}

/// What the whole hand feels in one control step.
#[pyclass(frozen, get_all, module = "feeler._core")]
pub struct HandSense {
    time: f64,
    fingers: Vec<Py<FingerSense>>,
}

impl HandSense {
    /// A copy of what `hand` feels.
    pub fn of(py: Python<'_>, hand: &sense::HandSense<'_>) -> PyResult<Self> {
        let fingers = hand
            .fingers()
            .map(|finger| Py::new(py, FingerSense::of(&finger)));
        Ok(Self {
            time: hand.stamp,
            fingers: fingers.collect::<PyResult<_>>()?,
        })
    }
}

#[pymethods]
impl HandSense {
    fn __repr__(&self) -> String {
        format!(
            "HandSense(time={:.3}, {} fingers)",
            self.time,
            self.fingers.len()
        )
    }
}

/// The phase called `name`.
pub fn phase(name: &str) -> PyResult<Phase> {
    let mut phases = Phase::ALL.into_iter();
    phases
        .find(|phase| phase_name(*phase) == name)
        .ok_or_else(|| {
            let names = Phase::ALL.map(phase_name).join(", ");
            PyValueError::new_err(format!("phase = {name:?}: expected one of {names}"))
        })
}

/// What `phase` is called in Python.
pub fn phase_name(phase: Phase) -> &'static str {
    match phase {
        Phase::Search => "search",
        Phase::Move => "move",
        Phase::Release => "release",
        Phase::Return => "return",
        Phase::Done => "done",
        Phase::Stopped => "stopped",
    }
}

fn python_bool(value: bool) -> &'static str {
    if value { "True" } else { "False" }
}

fn vector(py: Python<'_>, vector: DVec3) -> Bound<'_, PyArray1<f64>> {
    PyArray1::from_slice(py, &vector.to_array())
}

fn rows<'py>(py: Python<'py>, rows: &[DVec3]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let numbers = rows.iter().flat_map(|row| row.to_array());
    PyArray1::from_iter(py, numbers).reshape([rows.len(), 3])
}
