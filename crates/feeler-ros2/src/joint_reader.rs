//! Reads the joints of a hand from `sensor_msgs/JointState` by name.

use feeler::hand::{HandState, JointState as FingerJoints, MAX_FINGERS, MAX_JOINTS};
use feeler_record::ros::JointState;

/// Names of the joints of each finger, from the base to the fingertip.
pub type JointNames = Vec<Vec<String>>;

/// Error when reading joints.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum JointError {
    /// The number of fingers is 0 or too large.
    #[error("expected joint names of 1 to {MAX_FINGERS} fingers, got {0}")]
    Fingers(usize),
    /// The number of joints of a finger is 0 or too large.
    #[error("expected 1 to {MAX_JOINTS} joint names of finger {finger}, got {actual}")]
    Joints {
        /// Index of the finger.
        finger: usize,
        /// Number of joint names.
        actual: usize,
    },
    /// The message does not contain a joint.
    #[error("expected the joint state of {0}, found none")]
    Missing(String),
    /// A joint's position or velocity is missing or not finite.
    #[error("{quantity} of {joint}: expected a finite number, got {actual:?}")]
    Value {
        /// Name of the quantity.
        quantity: &'static str,
        /// Name of the joint.
        joint: String,
        /// Value in the message, or `None` if it is missing.
        actual: Option<f64>,
    },
}

/// Reads the joints of a hand from messages that may list them in any order.
#[derive(Debug, Clone)]
pub struct JointReader {
    names: JointNames,
    /// Index of each joint in the previous message, where it is looked up first in the next one.
    places: Vec<usize>,
}

impl JointReader {
    /// Creates a reader for joints with these names.
    ///
    /// # Errors
    /// If the number of fingers is not 1 to [`MAX_FINGERS`], or the number of joints of a finger is not 1 to
    /// [`MAX_JOINTS`].
    pub fn new(names: JointNames) -> Result<Self, JointError> {
        if !(1..=MAX_FINGERS).contains(&names.len()) {
            return Err(JointError::Fingers(names.len()));
        }
        for (finger, joints) in names.iter().enumerate() {
            let actual = joints.len();
            if !(1..=MAX_JOINTS).contains(&actual) {
                return Err(JointError::Joints { finger, actual });
            }
        }
        Ok(Self {
            places: vec![0; names.iter().map(Vec::len).sum()],
            names,
        })
    }

    /// Number of joints of each finger.
    pub fn joint_counts(&self) -> Vec<usize> {
        self.names.iter().map(Vec::len).collect()
    }

    /// Copies the joints from `message` to `state`, which must have as many fingers.
    /// Ignores other joints in the message, and does not change the stamp of `state`.
    ///
    /// # Errors
    /// Returns [`JointError::Missing`] if a joint is missing; `state` is then unchanged. Returns [`JointError::Value`]
    /// if a position or velocity is missing or not finite; the joints of `state` are then unspecified.
    pub fn read(&mut self, message: &JointState, state: &mut HandState) -> Result<(), JointError> {
        for (name, place) in self.names.iter().flatten().zip(&mut self.places) {
            if message.name.get(*place) != Some(name) {
                let found = message.name.iter().position(|other| other == name);
                *place = found.ok_or_else(|| JointError::Missing(name.clone()))?;
            }
        }
        let mut places = &self.places[..];
        for (names, joint) in self.names.iter().zip(&mut state.joints) {
            let (own, others) = places.split_at(names.len());
            places = others;
            *joint = FingerJoints::zero(names.len());
            for (index, (name, &place)) in names.iter().zip(own).enumerate() {
                let value = |quantity, values: &[f64]| {
                    let value = values.get(place).copied();
                    let wrong = || JointError::Value {
                        quantity,
                        joint: name.clone(),
                        actual: value,
                    };
                    value.filter(|value| value.is_finite()).ok_or_else(wrong)
                };
                joint.position[index] = value("position", &message.position)?;
                joint.velocity[index] = value("velocity", &message.velocity)?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message() -> JointState {
        JointState {
            name: ["c", "other", "a", "b"].map(String::from).to_vec(),
            position: vec![3.0, f64::NAN, 1.0, 2.0],
            velocity: vec![30.0, f64::NAN, 10.0, 20.0],
            ..JointState::default()
        }
    }

    fn reader() -> JointReader {
        JointReader::new(vec![["a", "b", "c"].map(String::from).to_vec()]).unwrap()
    }

    #[test]
    fn joints_are_found_by_name_in_any_order() {
        let (mut reader, mut state) = (reader(), HandState::zero(1));
        let mut message = message();
        for _ in 0..2 {
            reader.read(&message, &mut state).unwrap();
            assert_eq!(state.joints[0].position.as_slice(), [1.0, 2.0, 3.0]);
            assert_eq!(state.joints[0].velocity.as_slice(), [10.0, 20.0, 30.0]);
            message.name.reverse();
            message.position.reverse();
            message.velocity.reverse();
        }
    }

    #[test]
    fn missing_joints_and_values_are_reported() {
        let (mut reader, mut state) = (reader(), HandState::zero(1));
        reader.read(&message(), &mut state).unwrap();
        let (before, mut without) = (state.clone(), message());
        // A message without one of the joints has no effect.
        (without.name[0], without.position[3]) = ("z".into(), 9.0);
        assert_eq!(
            reader.read(&without, &mut state),
            Err(JointError::Missing("c".into()))
        );
        assert_eq!(state, before);
        let mut without = message();
        without.name[2] = "z".into();
        assert_eq!(
            reader.read(&without, &mut state),
            Err(JointError::Missing("a".into()))
        );
        for (quantity, wrong) in [("velocity", vec![]), ("velocity", vec![f64::INFINITY; 4])] {
            let message = JointState {
                velocity: wrong,
                ..message()
            };
            let error = reader.read(&message, &mut state);
            assert!(matches!(error, Err(JointError::Value { quantity: q, .. }) if q == quantity));
        }
        assert_eq!(
            JointReader::new(vec![]).unwrap_err(),
            JointError::Fingers(0)
        );
    }

    #[test]
    fn fingers_have_one_to_seven_joints() {
        let names = |joints: &[&str]| joints.iter().map(|name| name.to_string()).collect();
        let reader = JointReader::new(vec![names(&["a"]), names(&["c", "b"])]);
        let (mut reader, mut state) = (reader.unwrap(), HandState::zero(2));
        assert_eq!(reader.joint_counts(), [1, 2]);
        reader.read(&message(), &mut state).unwrap();
        let [first, second] = &state.joints[..] else {
            panic!("two fingers");
        };
        assert_eq!(first.position.as_slice(), [1.0]);
        assert_eq!(second.position.as_slice(), [3.0, 2.0]);
        assert_eq!(second.velocity.as_slice(), [30.0, 20.0]);
        for actual in [0, 8] {
            let refused = JointReader::new(vec![names(&["a"]), vec!["b".into(); actual]]);
            let finger = 1;
            assert_eq!(refused.unwrap_err(), JointError::Joints { finger, actual });
        }
    }
}
