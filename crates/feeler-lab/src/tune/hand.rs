//! Input of the tuning rules: the identified values of a hand, checked, and values defined by the experiment.

use super::TuneError;
use crate::config::Experiment;
use crate::identify::{Estimate, FingerEstimates, Identified};
use feeler::check::Checker;
use feeler::control::task::TaskConfig;
use feeler::control::task::screw::ScrewConfig;
use std::fs;
use std::path::Path;

/// Rated force (N) and stiffness (N/m) of the reference element.
const RATED: (f64, f64) = (0.505, 205.0);

/// Properties of a hand from which the tuning rules compute its settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hand {
    /// Contact stiffness of an element along its axis (N/m).
    pub normal_stiffness: f64,
    /// Contact stiffness of an element across its axis (N/m).
    pub shear_stiffness: f64,
    /// Coefficient of static friction.
    pub static_friction: f64,
    /// Coefficient of kinetic friction.
    pub kinetic_friction: f64,
    /// Time constant of the drives (s).
    pub servo_lag: f64,
    /// Standard deviation of the noise of one component of an element's force (N).
    pub force_noise: f64,
    /// Distance from the dome's centre to the object's axis at first contact (m).
    pub contact_radius: f64,
    /// Maximum force that an element is rated for (N).
    pub rated_force: f64,
    /// Control period (s).
    pub period: f64,
    /// Position of the axis about which the object turns, x and y in W (m).
    pub pivot: [f64; 2],
}

impl Hand {
    /// Combines the `identified` values with those of the `experiment`. Values of several fingers are averaged because
    /// the fingers share one `[control]` table. If the rated force `rated` (N) is `None`, it is estimated by
    /// [`rated_force`].
    ///
    /// # Errors
    /// If the task is not a `[task.screw]` with a fixed number of strokes under the paper's law.
    pub fn new(
        experiment: &Experiment,
        identified: &Identified,
        rated: Option<f64>,
    ) -> Result<Self, TuneError> {
        screw(experiment)?;
        let mean = |estimate: fn(&FingerEstimates) -> &Estimate| {
            let values = identified.finger.iter().map(|f| estimate(f).value);
            values.sum::<f64>() / identified.finger.len() as f64
        };
        let normal_stiffness = mean(|f| &f.normal_stiffness);
        let dome_radius = experiment.fingertip(None)?.layout.dome_radius;
        let object = &identified.object;
        Ok(Self {
            normal_stiffness,
            shear_stiffness: mean(|f| &f.shear_stiffness),
            static_friction: mean(|f| &f.static_friction),
            kinetic_friction: mean(|f| &f.kinetic_friction),
            servo_lag: mean(|f| &f.servo_lag),
            force_noise: mean(|f| &f.force_noise),
            contact_radius: object.radius.value + dome_radius,
            rated_force: rated.unwrap_or_else(|| rated_force(normal_stiffness)),
            period: experiment.config.control.period,
            pivot: [object.pivot_x.value, object.pivot_y.value],
        })
    }
}

/// Estimates the rated force (N) of an element of `normal_stiffness` (N/m) as the force at which it stores the same
/// elastic energy, F²/(2 k), as the reference element at its rated force.
pub fn rated_force(normal_stiffness: f64) -> f64 {
    let (force, stiffness) = RATED;
    force * (normal_stiffness / stiffness).sqrt()
}

/// Returns the screw task of `experiment`.
///
/// # Errors
/// If the experiment has another task or no fixed number of strokes, or its control law is not `tri-axial`.
pub fn screw(experiment: &Experiment) -> Result<&ScrewConfig, TuneError> {
    let config = &experiment.config;
    let refuse = |message: String| TuneError::Untunable {
        name: config.name.clone(),
        message,
    };
    let TaskConfig::Screw(screw) = &config.task else {
        let task = config.task.name();
        return Err(refuse(format!(
            "expected an experiment with [task.screw], got task.{task}"
        )));
    };
    let law = config.control.law.name();
    if law != PAPERS_LAW || !config.task.takes_law() {
        return Err(refuse(format!(
            "the rules require the control law {PAPERS_LAW:?} and a fixed number of strokes; got {law:?} and until = {:?}",
            screw.until
        )));
    }
    Ok(screw)
}

/// Control law to which the rules apply.
const PAPERS_LAW: &str = "tri-axial";

/// Reads the identified values of the experiment's hand.
///
/// # Errors
/// If the file cannot be read, a value is out of range, or the values belong to another experiment.
pub fn read_identified(path: &Path, experiment: &Experiment) -> Result<Identified, TuneError> {
    let text = fs::read_to_string(path).map_err(|source| TuneError::Read {
        path: path.to_path_buf(),
        source,
    })?;
    let refuse = |message: String| TuneError::Identified {
        path: path.to_path_buf(),
        message: message.trim_end().to_string(),
    };
    let identified: Identified = toml::from_str(&text).map_err(|e| refuse(e.to_string()))?;
    let name = &experiment.config.name;
    if identified.experiment != *name {
        return Err(refuse(format!(
            "expected values of the experiment {name:?}, got {:?}",
            identified.experiment
        )));
    }
    let (found, expected) = (identified.finger.len(), experiment.config.hand.finger.len());
    if found != expected {
        return Err(refuse(format!(
            "expected values of {expected} fingers, as in the hand of {name}, got {found}"
        )));
    }
    plausible(&identified).map_err(refuse)?;
    Ok(identified)
}

/// Requires all values to be physically possible.
///
/// # Errors
/// Lists every value that is out of range, one per line.
pub fn plausible(identified: &Identified) -> Result<(), String> {
    let mut checker = Checker::default();
    check(identified, &mut checker);
    let problems = checker.problems();
    let lines = problems.iter().map(|problem| format!("\n  {problem}"));
    match lines.collect::<String>() {
        lines if lines.is_empty() => Ok(()),
        lines => Err(format!("out of range:{lines}")),
    }
}

/// Checks that all estimates are physically possible.
fn check(identified: &Identified, checker: &mut Checker) {
    let object = &identified.object;
    let mut estimates = vec![
        ("object.pivot_x".to_string(), &object.pivot_x, -2.0, 2.0),
        ("object.pivot_y".to_string(), &object.pivot_y, -2.0, 2.0),
        ("object.radius".to_string(), &object.radius, 1e-3, 0.2),
    ];
    for (index, finger) in identified.finger.iter().enumerate() {
        let own = [
            ("force_noise", &finger.force_noise, 0.0, 1.0),
            ("normal_stiffness", &finger.normal_stiffness, 10.0, 1e5),
            ("shear_stiffness", &finger.shear_stiffness, 5.0, 1e5),
            ("static_friction", &finger.static_friction, 0.05, 5.0),
            ("kinetic_friction", &finger.kinetic_friction, 0.05, 5.0),
            ("servo_lag", &finger.servo_lag, 0.0, 0.5),
        ];
        let own = own.map(|(key, e, low, high)| (format!("finger[{index}].{key}"), e, low, high));
        estimates.extend(own);
        let (fixed, sliding) = (&finger.static_friction, &finger.kinetic_friction);
        let key = format!("finger[{index}].kinetic_friction.value");
        let expected = format!("at most static_friction, up to {}", fixed.high);
        checker.require(
            &key,
            sliding.value.to_string(),
            sliding.low <= fixed.high,
            &expected,
        );
    }
    for (
        key,
        Estimate {
            value, low, high, ..
        },
        least,
        most,
    ) in estimates
    {
        checker.between(&format!("{key}.value"), *value, least, most);
        let ordered = low.is_finite() && high.is_finite() && low <= value && value <= high;
        let expected = format!("low <= {value} <= high");
        checker.require(&key, format!("[{low}, {high}]"), ordered, &expected);
    }
}
