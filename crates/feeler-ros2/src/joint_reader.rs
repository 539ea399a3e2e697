//! The joints of a hand, by their names, from `sensor_msgs/JointState`.

use feeler::hand::{HandState, MAX_FINGERS};
use feeler_record::ros::JointState;

/// Names of the joints theta1..theta3 of each finger.
pub type JointNames = Vec<[String; 3]>;

/// Why joints cannot be read.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum JointError {
    /// There are too few or too many fingers.
    #[error("joint names of 1 to {MAX_FINGERS} fingers expected, found {0}")]
    Fingers(usize),
    /// A joint is not there.
    #[error("joint state of {0} expected, found none")]
    Missing(String),
    /// A joint has no value, or one that is no number.
    #[error("{quantity} of {joint}: a finite number expected, found {actual:?}")]
    Value {
        /// What.
        quantity: &'static str,
        /// Whose.
        joint: String,
        /// What there is.
        actual: Option<f64>,
    },
}

/// Reads the joints of a hand.
#[derive(Debug, Clone)]
pub struct JointReader {
    names: JointNames,
    /// Where each was found last time: it will be there again.
    places: Vec<usize>,
}

impl JointReader {
    /// Of a hand whose joints have these names.
    ///
    /// # Errors
    /// When these are too few or too many.
    pub fn new(names: JointNames) -> Result<Self, JointError> {
        match names.len() {
            1..=MAX_FINGERS => Ok(Self {
                places: vec![0; 3 * names.len()],
                names,
            }),
            other => Err(JointError::Fingers(other)),
        }
    }

    /// Number of fingers.
    pub fn finger_count(&self) -> usize {
        self.names.len()
    }

    /// Fills the joints of `state`, of as many fingers, with those of `message`; its time is left. Other joints are left out.
    ///
    /// # Errors
    /// When a joint is missing: then `state` is as before. When one has no position or velocity: then `state` is of no use.
    pub fn read(&mut self, message: &JointState, state: &mut HandState) -> Result<(), JointError> {
        for (name, place) in self.names.iter().flatten().zip(&mut self.places) {
            if message.name.get(*place) != Some(name) {
                let found = message.name.iter().position(|other| other == name);
                *place = found.ok_or_else(|| JointError::Missing(name.clone()))?;
            }
        }
        let joints = self.names.iter().zip(&mut state.joints);
        for ((names, joint), places) in joints.zip(self.places.chunks_exact(3)) {
            for (axis, (name, &place)) in names.iter().zip(places).enumerate() {
                let value = |quantity, values: &[f64]| {
                    let value = values.get(place).copied();
                    let wrong = || JointError::Value {
                        quantity,
                        joint: name.clone(),
                        actual: value,
                    };
                    value.filter(|value| value.is_finite()).ok_or_else(wrong)
                };
                joint.position[axis] = value("position", &message.position)?;
                joint.velocity[axis] = value("velocity", &message.velocity)?;
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
    fn joints_are_found_by_name_wherever_they_are() {
        let (mut reader, mut state) = (reader(), HandState::zero(1));
        let mut message = message();
        for _ in 0..2 {
            reader.read(&message, &mut state).unwrap();
            assert_eq!(state.joints[0].position.to_array(), [1.0, 2.0, 3.0]);
            assert_eq!(state.joints[0].velocity.to_array(), [10.0, 20.0, 30.0]);
            message.name.reverse();
            message.position.reverse();
            message.velocity.reverse();
        }
    }

    #[test]
    fn what_is_missing_is_named() {
        let (mut reader, mut state) = (reader(), HandState::zero(1));
        reader.read(&message(), &mut state).unwrap();
        let (before, mut without) = (state.clone(), message());
        // Of another part of the robot: nothing is taken of it.
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
