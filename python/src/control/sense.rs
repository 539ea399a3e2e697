//! Readings of a hand and plans of a task, as Python objects.

use feeler::control::{Phase, plan, sense};
use feeler::hand::JointVector;
use glam::DVec3;
use numpy::{PyArray1, PyArray2, PyArrayMethods as _};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// A vector with three components.
pub type Vector = [f64; 3];

/// Motion that a task plans for a finger.
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

    /// Velocity of the fingertip [3], m/s, in W.
    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.0.velocity)
    }

    /// Assumed direction to the object, a unit vector [3] in W.
    #[getter]
    fn towards_object<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.0.towards_object)
    }

    /// `True` if the finger is re-compressed when it slips.
    #[getter]
    fn reflex(&self) -> bool {
        self.0.reflex
    }

    /// `True` if the finger is re-compressed when its grasp force is low.
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

/// Readings and pose of one finger.
#[pyclass(frozen, module = "feeler._core")]
pub struct FingerSense {
    force: Vec<DVec3>,
    normals: Vec<DVec3>,
    shear_rate: Vec<f64>,
    flags: feeler::control::FingerFlags,
    pose: sense::FingertipPose,
    joints: feeler::hand::JointState,
    resultant: DVec3,
}

impl FingerSense {
    /// Copies the readings of `finger`.
    pub fn of(finger: &sense::FingerReadings<'_>) -> Self {
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
    /// Force on each feeler by the object, in `E_i` [E, 3], N; z is compression, positive when pressed.
    #[getter]
    fn force<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, &self.force)
    }

    /// The dome's outward normal at each element [E, 3], unit vectors in W.
    #[getter]
    fn normal<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, &self.normals)
    }

    /// Shear rate of each element [E], N/s.
    #[getter]
    fn shear_rate<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.shear_rate)
    }

    /// TOUCH: the compression of an element is above the threshold F1, or SLIP is raised.
    #[getter]
    fn touch(&self) -> bool {
        self.flags.touch
    }

    /// SLIP: the shear rate of an element is above the threshold dr.
    #[getter]
    fn slip(&self) -> bool {
        self.flags.slip
    }

    /// OVER: the compression of an element is above the threshold F2.
    #[getter]
    fn over(&self) -> bool {
        self.flags.over
    }

    /// Touching element with the largest compression, or `None` if no element touches.
    #[getter]
    fn largest_element(&self) -> Option<usize> {
        self.flags.largest_element
    }

    /// Sum of the elements' compressions, N.
    #[getter]
    fn grasp_force(&self) -> f64 {
        self.flags.grasp_force
    }

    /// Position of the dome's centre [3], m, in W, from the encoders.
    #[getter]
    fn position<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, self.pose.position)
    }

    /// Rotation from the fingertip's frame `T` to W [3, 3].
    #[getter]
    fn rotation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows_of = self.pose.rotation.transpose();
        rows(py, &[rows_of.x_axis, rows_of.y_axis, rows_of.z_axis])
    }

    /// Joint positions, one per joint [J], rad, or m for a prismatic joint.
    #[getter]
    fn joint_position<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        joint_numbers(py, &self.joints.position)
    }

    /// Joint velocities, one per joint [J], rad/s, or m/s for a prismatic joint.
    #[getter]
    fn joint_velocity<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        joint_numbers(py, &self.joints.velocity)
    }

    /// Resultant force on the fingertip by the object [3], N, in W.
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

/// Readings of the whole hand in one control step.
#[pyclass(frozen, get_all, module = "feeler._core")]
pub struct HandSense {
    /// Time of the control step, s.
    time: f64,
    /// Readings of each finger.
    fingers: Vec<Py<FingerSense>>,
}

impl HandSense {
    /// Copies the readings of `hand`.
    pub fn of(py: Python<'_>, hand: &sense::HandReadings<'_>) -> PyResult<Self> {
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

/// Returns the phase called `name`.
pub fn phase(name: &str) -> PyResult<Phase> {
    let mut phases = Phase::ALL.into_iter();
    phases
        .find(|phase| phase.to_string() == name)
        .ok_or_else(|| {
            let names = Phase::ALL.map(|phase| phase.to_string()).join(", ");
            PyValueError::new_err(format!("phase = {name:?}: expected one of {names}"))
        })
}

fn python_bool(value: bool) -> &'static str {
    if value { "True" } else { "False" }
}

fn vector(py: Python<'_>, vector: DVec3) -> Bound<'_, PyArray1<f64>> {
    PyArray1::from_slice(py, &vector.to_array())
}

/// Converts a quantity of a finger's joints to an array with one value per joint.
fn joint_numbers<'py>(py: Python<'py>, joints: &JointVector) -> Bound<'py, PyArray1<f64>> {
    PyArray1::from_slice(py, joints.as_slice())
}

fn rows<'py>(py: Python<'py>, rows: &[DVec3]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let numbers = rows.iter().flat_map(|row| row.to_array());
    PyArray1::from_iter(py, numbers).reshape([rows.len(), 3])
}
