//! Reads the joints of a hand from `sensor_msgs/JointState` by name.

use feeler::hand::{HandState, JointState as FingerJoints, MAX_FINGERS};
use feeler_record::ros::JointState;

/// Number of joints of each finger of a robot.
pub(crate) const JOINTS: usize = 3;

/// Names of the joints `theta1` to `theta3` of each finger.
pub type JointNames = Vec<[String; JOINTS]>;

/// Error when reading joints.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum JointError {
    /// The number of fingers is 0 or too large.
    #[error("expected joint names of 1 to {MAX_FINGERS} fingers, got {0}")]
    Fingers(usize),
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
        /// Value in the message, if any.
        actual: Option<f64>,
    },
}

/// Reads the joints of a hand from messages that may list them in any order.
#[derive(Debug, Clone)]
pub struct JointReader {
    names: JointNames,
    /// Index of each joint in the previous message, tried first in the next.
    places: Vec<usize>,
}

impl JointReader {
    /// Creates a reader for joints with these names.
    ///
    /// # Errors
    /// If the number of fingers is not 1 to [`MAX_FINGERS`].
    pub fn new(names: JointNames) -> Result<Self, JointError> {
        match names.len() {
            1..=MAX_FINGERS => Ok(Self {
                places: vec![0; JOINTS * names.len()],
                names,
            }),
            other => Err(JointError::Fingers(other)),
        }
    }

    /// Number of fingers.
    pub fn finger_count(&self) -> usize {
        self.names.len()
    }

    /// Copies the joints from `message` to `state`, which must have [`finger_count`](Self::finger_count) fingers.
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
        let joints = self.names.iter().zip(&mut state.joints);
        for ((names, joint), places) in joints.zip(self.places.chunks_exact(JOINTS)) {
            *joint = FingerJoints::zero(JOINTS);
            for (index, (name, &place)) in names.iter().zip(places).enumerate() {
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
        JointReader::new(vec![["a", "b", "c"].map(String::from)]).unwrap()
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
}
