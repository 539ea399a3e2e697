//! Forces of a fingertip as a LeRobot feature, from and to a [`TactileArray`].

use feeler::sensor::fingertip::{MAX_ELEMENTS, SensingElement};
use feeler_record::Recording;
use feeler_record::ros::{Header, Time};
use feeler_record::tactile_array::{
    ArrayError, ELEMENT_AXES, TactileArray, TactileChannel, of_finger, to_recorded,
};
use feeler_record::wire::{Quaternion, Vector3};
use glam::{DQuat, DVec3};
use serde_json::{Map, Value, json};

/// Convention of the values.
const AXES: &str =
    "x, y: tangential force on the element by the object; z: compression, positive when pressed";

/// Feature of the forces on a fingertip: its description in `info.json`, and its values in one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceFeature {
    /// Description: type, shape, names, units, axes, positions and orientations of the elements.
    pub description: Value,
    /// Force on each element in its frame (N), compression positive; NaN if unknown.
    pub values: Vec<f32>,
}

/// Error when reading a feature of forces.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FeatureError {
    /// A part of the description, or the number of values, is invalid.
    #[error("{part}: expected {expected}, got {actual}")]
    Part {
        /// Name of the invalid part.
        part: &'static str,
        /// Expected content.
        expected: String,
        /// Actual content.
        actual: String,
    },
    /// The elements are invalid.
    #[error(transparent)]
    Array(#[from] ArrayError),
}

/// Converts the forces of an array to a feature. Numbers are rounded to 32 bits. Time and sequence number are lost
/// (LeRobot computes times from frame number and rate), and so are contact, thresholds, calibration, variances,
/// saturation and other channels.
///
/// # Errors
/// If the array is invalid or has no forces in newtons.
pub fn to_feature(array: &TactileArray) -> Result<ForceFeature, ArrayError> {
    let forces = to_recorded(array)?.forces;
    let values = forces.iter().flat_map(|force| [force.x, force.y, force.z]);
    let mut description = about(&array.positions, &array.orientations);
    description.insert("units".into(), json!("N"));
    description.insert("dtype".into(), json!("float32"));
    description.insert("shape".into(), json!([forces.len(), 3]));
    description.insert("names".into(), json!(["element", "axis"]));
    Ok(ForceFeature {
        description: Value::Object(description),
        values: values.map(|value| value as f32).collect(),
    })
}

/// Converts a feature of forces, such as `observation.tactile.finger_0.force`, to an array of the sensor `sensor` at
/// time 0. Without orientations, normals point away from the origin, as on a dome.
///
/// # Errors
/// If the description or the number of values is invalid.
pub fn from_feature(feature: &ForceFeature, sensor: &str) -> Result<TactileArray, FeatureError> {
    let ForceFeature {
        description,
        values,
    } = feature;
    let part = |part, expected: &str, actual: &Value| FeatureError::Part {
        part,
        expected: expected.into(),
        actual: actual.to_string(),
    };
    if description["units"] != "N" {
        return Err(part("units", "\"N\"", &description["units"]));
    }
    let positions = &description["element_positions_m"];
    let positions: Vec<[f64; 3]> = serde_json::from_value(positions.clone())
        .map_err(|_| part("element_positions_m", "a list of [x, y, z]", positions))?;
    let elements = positions.len();
    if !(1..=MAX_ELEMENTS).contains(&elements) || values.len() != 3 * elements {
        let expected = format!("1 to {MAX_ELEMENTS} elements and 3 values of each");
        let actual = json!([elements, values.len()]);
        return Err(part("values", &expected, &actual));
    }
    let orientations = match &description["element_orientations_xyzw"] {
        Value::Null => positions.iter().map(|&tip| facing(tip)).collect(),
        given => serde_json::from_value::<Vec<[f64; 4]>>(given.clone())
            .map_err(|_| part("element_orientations_xyzw", "a list of [x, y, z, w]", given))?
            .into_iter()
            .map(|turn| DQuat::from_array(turn).into())
            .collect(),
    };
    let mut array = TactileArray {
        positions: positions.into_iter().map(vector).collect(),
        orientations,
        channels: vec![TactileChannel {
            axes: ELEMENT_AXES,
            ..TactileChannel::of_forces()
        }],
        ..TactileArray::unknown(&Header::of(sensor))
    };
    let forces = values.chunks_exact(3);
    let forces = forces.map(|v| DVec3::new(v[0].into(), v[1].into(), v[2].into()));
    array.set_sample(Time::default(), 0, forces, &[]);
    // Not determined, rather than none.
    array.contact.clear();
    array.check()?;
    Ok(array)
}

/// Key of a tactile feature of one finger.
pub(super) fn tactile_key(finger: usize, what: &str) -> String {
    format!("observation.tactile.finger_{finger}.{what}")
}

/// Description of the axes of a finger's forces, and of its elements if they are known.
pub(super) fn about_forces(recording: &Recording, finger: usize) -> Map<String, Value> {
    let sensor = of_finger(&recording.facts, finger);
    let sensor = sensor.map(|sensor| about(&sensor.positions, &sensor.orientations));
    sensor.unwrap_or_else(|| axes().into_iter().collect())
}

/// Description of the axes, and positions and orientations of the elements.
fn about(positions: &[Vector3], orientations: &[Quaternion]) -> Map<String, Value> {
    let positions: Vec<_> = positions.iter().map(|p| [p.x, p.y, p.z]).collect();
    let orientations: Vec<_> = orientations.iter().map(|q| [q.x, q.y, q.z, q.w]).collect();
    let geometry = [
        ("element_positions_m".into(), json!(positions)),
        ("element_orientations_xyzw".into(), json!(orientations)),
    ];
    axes().into_iter().chain(geometry).collect()
}

/// Description of the axes.
fn axes() -> [(String, Value); 1] {
    [("axes".into(), json!(AXES))]
}

fn facing(tip: [f64; 3]) -> Quaternion {
    let outward = DVec3::from_array(tip).normalize_or(DVec3::X);
    DQuat::from_mat3(&SensingElement::facing(outward).rotation).into()
}

fn vector([x, y, z]: [f64; 3]) -> Vector3 {
    Vector3 { x, y, z }
}

#[cfg(test)]
mod tests {
    use super::*;
    use feeler_record::tactile_array::INVALID;

    fn array() -> TactileArray {
        let tips = [[0.018, 0.0, 0.0], [0.012, 0.010, -0.008]];
        let feature = ForceFeature {
            description: json!({ "units": "N", "element_positions_m": tips }),
            values: vec![0.5, -0.25, 0.125, f32::NAN, f32::NAN, f32::NAN],
        };
        from_feature(&feature, "finger_0").expect("an array")
    }

    #[test]
    fn forces_return_unchanged() {
        let feature = to_feature(&array()).expect("a feature");
        assert_eq!(feature.values[..3], [0.5, -0.25, 0.125]);
        assert!(feature.values[3..].iter().all(|value| value.is_nan()));
        let back = from_feature(&feature, "finger_0").expect("an array");
        assert_eq!(back.positions, array().positions);
        assert_eq!(back.orientations, array().orientations);
        assert_eq!(back.channels[0].status, [0, INVALID]);
        // A press of 0.125 N: along -z of the element.
        assert_eq!(back.channels[0].values[..3], [0.5, -0.25, -0.125]);
        assert!(back.contact.is_empty());
    }

    #[test]
    fn unsuitable_features_are_rejected_with_a_reason() {
        let good = to_feature(&array()).expect("a feature");
        let refused = |key: &str, value: Value, words: &str| {
            let mut feature = good.clone();
            feature.description[key] = value;
            let error = from_feature(&feature, "")
                .expect_err("an error")
                .to_string();
            assert!(error.contains(words), "{error}");
        };
        refused("units", json!("mN"), "units: expected \"N\"");
        refused("element_positions_m", Value::Null, "a list of [x, y, z]");
        refused("element_positions_m", json!([[1.0, 2.0]]), "a list of [x");
        refused("element_positions_m", json!([]), "got [0,6]");
        refused("element_positions_m", json!([[0, 0, 1]]), "got [1,6]");
        let one = json!([[0.0, 0.0, 0.0, 1.0]]);
        refused("element_orientations_xyzw", one, "2 entries");
        let bad = json!([[0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]]);
        refused("element_orientations_xyzw", bad, "element 0");
        refused("element_orientations_xyzw", json!("q"), "a list of [x");
        let mut odd = good.clone();
        odd.description = json!(7);
        assert!(from_feature(&odd, "").is_err());
    }
}
