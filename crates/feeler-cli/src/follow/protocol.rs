//! Requests and answers of `feeler follow`: one JSON object per line. The book's page on learning describes them.

use super::board::{FingerSnapshot, Snapshot};
use feeler::control::task::follow::HandVelocities;
use feeler::hand::{FingerGeometry, JointVector};
use feeler_lab::config::ExperimentConfig;
use feeler_record::messages::joint_names;
use glam::DVec3;
use serde_json::{Map, Value, json};

/// Version of the protocol.
const PROTOCOL: u32 = 1;

/// Decodes a request to a hand whose fingers have `joints` joints: the requested velocities, which are answered with the
/// readings after the next control step, or `None` for the latest readings.
///
/// # Errors
/// Returns the error message if the line is not a request.
pub fn decode(line: &str, joints: &[usize]) -> Result<Option<HandVelocities>, String> {
    let request: Map<String, Value> = serde_json::from_str(line)
        .map_err(|error| format!("expected a JSON object per line: {error}"))?;
    if let Some(key) = request.keys().find(|key| *key != "velocity") {
        return Err(format!(
            "expected the key \"velocity\" or none, got {key:?}"
        ));
    }
    let Some(velocity) = request.get("velocity") else {
        return Ok(None);
    };
    let expected = || format!("velocity: expected a list per finger of {joints:?} numbers");
    let fingers: Vec<Vec<f64>> = serde_json::from_value(velocity.clone())
        .map_err(|error| format!("{}: {error}", expected()))?;
    let counts: Vec<_> = fingers.iter().map(Vec::len).collect();
    if counts != joints {
        return Err(format!("{}, got {counts:?}", expected()));
    }
    let mut velocities = HandVelocities::default();
    for (own, finger) in velocities.iter_mut().zip(&fingers) {
        *own = JointVector::from_slice(finger).ok_or_else(expected)?;
    }
    Ok(Some(velocities))
}

/// Description of the hand, the first line of the output.
pub fn description(
    config: &ExperimentConfig,
    fingers: &[FingerGeometry],
    elements: &[usize],
    lifetime: f64,
) -> Value {
    let fingers = fingers.iter().zip(elements).enumerate();
    let fingers = fingers.map(|(finger, (geometry, elements))| {
        let numbers = |numbers: JointVector| json!(numbers.as_slice());
        json!({
            "joints": joint_names(finger, geometry.joint_count()).collect::<Vec<_>>(),
            "lower": numbers(geometry.joint_lower()),
            "upper": numbers(geometry.joint_upper()),
            "speed": numbers(geometry.joint_speed_limit()),
            "elements": elements,
        })
    });
    json!({
        "protocol": PROTOCOL,
        "experiment": config.name,
        "period": config.control.period,
        "lifetime": lifetime,
        "fingers": fingers.collect::<Vec<_>>(),
    })
}

/// Answer with the readings `snapshot`.
pub fn readings(snapshot: &Snapshot) -> Value {
    json!({
        "time": snapshot.time,
        "age": snapshot.changed.elapsed().as_secs_f64(),
        "phase": snapshot.phase.to_string(),
        "stopped": snapshot.stopped,
        "fingers": snapshot.fingers.iter().map(finger).collect::<Vec<_>>(),
    })
}

fn finger(finger: &FingerSnapshot) -> Value {
    // A number that is not finite becomes null.
    let force = |force: &DVec3| json!([force.x, force.y, force.z]);
    json!({
        "position": finger.joints.position.as_slice(),
        "velocity": finger.joints.velocity.as_slice(),
        "command": finger.command.as_slice(),
        "force": finger.forces.iter().map(force).collect::<Vec<_>>(),
        "touch": finger.flags.touch,
        "slip": finger.flags.slip,
        "over": finger.flags.over,
        "grasp_force": finger.flags.grasp_force,
        "sensed_at": finger.sensed_at,
    })
}

/// Answer to a request that cannot be executed.
pub fn error(reason: &str) -> Value {
    json!({ "error": reason })
}

/// Answer before the first control step, while the hand waits for its other programs.
pub fn waiting() -> Value {
    json!({ "waiting": true })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn requests_are_decoded_or_rejected_with_a_reason() {
        assert_eq!(decode("{}", &[3, 1]), Ok(None));
        let Ok(Some(velocities)) = decode(r#"{"velocity": [[1, -2.5, 0], [0.5]]}"#, &[3, 1]) else {
            panic!("no velocities");
        };
        assert_eq!(velocities[0].as_slice(), [1.0, -2.5, 0.0]);
        assert_eq!(velocities[1].as_slice(), [0.5]);
        let refused = [
            ("", "expected a JSON object"),
            ("[]", "expected a JSON object"),
            (r#"{"velocity": [[1, 2, 3]]}"#, "[3, 1] numbers, got [3]"),
            (r#"{"velocity": [[1, 2], [3]]}"#, "got [2, 1]"),
            (r#"{"velocity": [[1, 2, null], [3]]}"#, "invalid type: null"),
            (r#"{"velocity": [[1, 2, 1e999], [3]]}"#, "out of range"),
            (r#"{"velocity": 3}"#, "a list per finger"),
            (r#"{"speed": 3}"#, r#"got "speed""#),
        ];
        for (line, words) in refused {
            let reason = decode(line, &[3, 1]).expect_err(line);
            assert!(reason.contains(words), "{line}: {reason}");
        }
    }

    proptest! {
        #[test]
        fn no_line_panics_and_only_finite_velocities_are_accepted(line in r#"(\{"velocity": ?\[\[[-0-9eE.,]{0,40}\]\]\}|.{0,60})"#) {
            if let Ok(Some(velocities)) = decode(&line, &[3]) {
                prop_assert!(velocities[0].iter().all(f64::is_finite));
                prop_assert_eq!(velocities[0].len(), 3);
            }
        }
    }
}
