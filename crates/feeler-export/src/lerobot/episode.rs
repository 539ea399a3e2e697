//! LeRobot features of an episode's frames.

use super::feature::{Feature, Values};
use super::frames::Frames;
use super::tactile::{about_forces, tactile_key};
use super::window::windows;
use crate::error::ExportError;
use crate::joint_units::joint_units;
use feeler::hand::JointVector;
use feeler_record::messages::joint_names;
use feeler_record::{Felt, FingerRecord, FingerStep, Recording, Step};
use serde_json::{Map, Value, json};

/// Observations and actions at these frames, with windows of `window` tactile samples.
///
/// # Errors
/// If the number of elements differs between frames, if a value is unknown (NaN), or if a window is too short.
pub(crate) fn features(
    run: &str,
    recording: &Recording,
    frames: &Frames<'_>,
    window: Option<usize>,
) -> Result<Vec<Feature>, ExportError> {
    let fingers = recording.fingers.len();
    let counts = joint_counts(recording);
    let names = |suffix: &str| -> Value {
        let joints = counts.iter().enumerate();
        let joints = joints.flat_map(|(finger, count)| joint_names(finger, *count));
        joints.map(|joint| format!("{joint}.{suffix}")).collect()
    };
    let taken = Taken {
        run,
        frames: &frames.steps,
    };
    let all = |numbers: fn(&FingerStep<'_>) -> Option<JointVector>| {
        move |step: &Step<'_>| {
            (step.fingers.iter())
                .filter_map(numbers)
                .flatten()
                .collect()
        }
    };
    let angles = all(|finger| Some(finger.joints?.position));
    let velocities = all(|finger| Some(finger.command?.joint_velocity));
    let width = vec![counts.iter().sum()];
    let [position, velocity] = joint_units(&recording.facts.hand);
    let mut features = vec![
        taken.numbers(
            "observation.state",
            width.clone(),
            position,
            names("pos"),
            angles,
        )?,
        taken.numbers("action", width, velocity, names("vel"), velocities)?,
    ];
    for finger in 0..fingers {
        features.extend(touch(&taken, recording, finger)?);
        if let Some(length) = window {
            features.extend(windows(run, recording, finger, frames, length)?);
        }
    }
    if !recording.felt.is_empty() {
        features.push(felt(&taken)?);
    }
    Ok(features)
}

/// Number of joints of each finger.
fn joint_counts(recording: &Recording) -> Vec<usize> {
    let first = |finger: &FingerRecord| Some(finger.joints.first()?.position.len());
    let counts = recording.fingers.iter().map(first);
    counts.map(|count| count.unwrap_or(3)).collect()
}

/// Tactile features of one finger.
fn touch(
    taken: &Taken<'_, '_>,
    recording: &Recording,
    finger: usize,
) -> Result<[Feature; 3], ExportError> {
    let key = |what: &str| tactile_key(finger, what);
    let elements = taken
        .frames
        .first()
        .and_then(|step| step.finger(finger)?.tactile);
    let elements = elements.map_or(0, |frame| frame.forces.len());
    let mut forces = taken.numbers(
        &key("force"),
        vec![elements, 3],
        "N",
        json!(["element", "axis"]),
        |step| {
            let frame = step.finger(finger).and_then(|finger| finger.tactile);
            let forces = frame.into_iter().flat_map(|frame| &frame.forces);
            forces
                .flat_map(|force| [force.x, force.y, force.z])
                .collect()
        },
    )?;
    forces.about.extend(about_forces(recording, finger));
    let grasp = taken.numbers(&key("grasp_force"), vec![1], "N", Value::Null, |step| {
        let flags = step.finger(finger).and_then(|finger| finger.flags);
        flags.map(|flags| flags.grasp_force).into_iter().collect()
    })?;
    let flags = taken
        .frames
        .iter()
        .filter_map(|step| step.finger(finger)?.flags);
    let flags = Feature {
        key: key("flags"),
        shape: vec![3],
        names: json!(["touch", "slip", "over"]),
        about: Map::new(),
        values: Values::Bool(flags.flat_map(|f| [f.touch, f.slip, f.over]).collect()),
    };
    Ok([forces, flags, grasp])
}

/// Rumble and tone that the live page played.
fn felt(taken: &Taken<'_, '_>) -> Result<Feature, ExportError> {
    let names = json!([
        "rumble_strong",
        "rumble_weak",
        "tone_frequency",
        "tone_gain"
    ]);
    let played = |step: &Step<'_>| {
        let felt = step.felt.copied().unwrap_or(Felt::SILENT);
        let rumble = [felt.rumble_strong, felt.rumble_weak];
        [rumble, [felt.tone_frequency, felt.tone_gain]].concat()
    };
    taken.numbers("operator.felt", vec![4], "1, 1, Hz, 1", names, played)
}

/// Frames from which features are extracted.
struct Taken<'f, 'a> {
    run: &'f str,
    frames: &'f [Step<'a>],
}

impl<'a> Taken<'_, 'a> {
    /// Extracts a numeric feature; each frame must have as many values as `shape` implies.
    fn numbers(
        &self,
        key: &str,
        shape: Vec<usize>,
        unit: &str,
        names: Value,
        of_frame: impl Fn(&Step<'a>) -> Vec<f64>,
    ) -> Result<Feature, ExportError> {
        let count = shape.iter().product::<usize>();
        let mut values = Vec::with_capacity(count * self.frames.len());
        for frame in self.frames {
            let numbers = of_frame(frame);
            let refuse = |expected: String, actual: &str| {
                let actual = format!("{actual} at {} s", frame.task.stamp);
                Err(ExportError::of_run(self.run, key, expected, actual))
            };
            if count == 0 || numbers.len() != count {
                let expected = format!("{} numbers", count.max(1));
                return refuse(expected, &numbers.len().to_string());
            }
            if numbers.iter().any(|number| !number.is_finite()) {
                return refuse("known numbers".into(), "an unknown one");
            }
            values.extend(numbers.iter().map(|&number| number as f32));
        }
        Ok(Feature {
            key: key.into(),
            shape,
            names,
            about: Map::from_iter([("units".into(), json!(unit))]),
            values: Values::Float(values),
        })
    }
}
