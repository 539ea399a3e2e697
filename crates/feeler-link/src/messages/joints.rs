//! Conversion of joint quantities from and to messages.

use super::rejection::Rejection;
use feeler::hand::{HandError, JointEfforts, JointVector, MAX_JOINTS};
use feeler_record::wire::Vector3;

/// Number of joints per vector of a message.
const PER_VECTOR: usize = 3;

/// Number of joints of each finger, which defines the layout of joint quantities in messages: each finger has one
/// vector per three joints, and unused components are 0.
///
/// All programs of a rig take it from their experiment.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct JointCounts(Vec<usize>);

impl JointCounts {
    /// Creates the layout for fingers with these numbers of joints. Any further finger has three joints.
    pub fn new(joints: impl IntoIterator<Item = usize>) -> Self {
        let joints = joints.into_iter();
        Self(joints.map(|count| count.min(MAX_JOINTS)).collect())
    }

    /// Returns the number of joints of `finger`.
    pub fn of_finger(&self, finger: usize) -> usize {
        self.0.get(finger).copied().unwrap_or(PER_VECTOR)
    }

    /// Returns the total number of vectors of a hand with this number of fingers.
    pub fn vectors(&self, fingers: usize) -> usize {
        let vectors = |finger| self.of_finger(finger).div_ceil(PER_VECTOR);
        (0..fingers).map(vectors).sum()
    }

    /// Converts the joint quantities of all fingers to vectors of a message; missing quantities are 0.
    ///
    /// # Errors
    /// [`HandError::JointCount`] if a finger has more joints than expected.
    pub fn to_message(
        &self,
        fingers: impl IntoIterator<Item = JointVector>,
    ) -> Result<Vec<Vector3>, HandError> {
        let mut vectors = Vec::new();
        for (finger, joints) in fingers.into_iter().enumerate() {
            let (expected, actual) = (self.of_finger(finger), joints.len());
            if actual > expected {
                return Err(HandError::JointCount { expected, actual });
            }
            let padded = joints.padded(expected);
            let chunks = padded.as_slice().chunks(PER_VECTOR);
            vectors.extend(chunks.map(|chunk| {
                let component = |index: usize| chunk.get(index).copied().unwrap_or_default();
                Vector3 {
                    x: component(0),
                    y: component(1),
                    z: component(2),
                }
            }));
        }
        Ok(vectors)
    }

    /// Converts the vectors of a message to the joint quantities of each finger. The iteration ends at the first finger
    /// whose vectors are missing.
    pub fn of_message<'a>(
        &'a self,
        vectors: &'a [Vector3],
    ) -> impl Iterator<Item = JointVector> + Clone + 'a {
        self.split(vectors).map(|(joints, vectors)| {
            let mut quantities = JointVector::zeros(joints);
            for (joint, value) in numbers(vectors).take(joints).enumerate() {
                quantities[joint] = value;
            }
            quantities
        })
    }

    /// Converts the efforts of all fingers, and their uncertainties, to vectors of a message: NaN for a finger that
    /// measures none, or empty if no finger measures any.
    ///
    /// # Errors
    /// As [`to_message`](Self::to_message).
    pub fn efforts_to_message(
        &self,
        fingers: &[JointEfforts],
    ) -> Result<(Vec<Vector3>, Vec<Vector3>), HandError> {
        if fingers.iter().all(|efforts| efforts.effort.is_empty()) {
            return Ok((Vec::new(), Vec::new()));
        }
        let effort = |(finger, efforts): (usize, &JointEfforts)| match efforts.effort.is_empty() {
            true => JointVector::splat(self.of_finger(finger), f64::NAN),
            false => efforts.effort,
        };
        let uncertainties = fingers.iter().map(|efforts| efforts.uncertainty);
        Ok((
            self.to_message(fingers.iter().enumerate().map(effort))?,
            self.to_message(uncertainties)?,
        ))
    }

    /// Checks that `vectors` matches the joints of a hand with this number of fingers, and that unused components are
    /// 0.
    pub(crate) fn check(&self, fingers: usize, vectors: &[Vector3]) -> Result<(), Rejection> {
        let mut unused = self
            .split(vectors)
            .flat_map(|(joints, vectors)| numbers(vectors).skip(joints));
        let is_whole = vectors.len() == self.vectors(fingers) && unused.all(|value| value == 0.0);
        is_whole.then_some(()).ok_or(Rejection::Size)
    }

    /// Splits `vectors` into the fingers' parts, each with the number of joints, until no complete part remains.
    fn split<'a>(
        &'a self,
        mut vectors: &'a [Vector3],
    ) -> impl Iterator<Item = (usize, &'a [Vector3])> + Clone {
        (0..).map_while(move |finger| {
            if vectors.is_empty() {
                return None;
            }
            let joints = self.of_finger(finger);
            let (own, others) = vectors.split_at_checked(joints.div_ceil(PER_VECTOR))?;
            vectors = others;
            Some((joints, own))
        })
    }
}

fn numbers(vectors: &[Vector3]) -> impl Iterator<Item = f64> {
    vectors
        .iter()
        .flat_map(|vector| [vector.x, vector.y, vector.z])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn three_joints_keep_their_numbers_and_more_are_refused() {
        let usual = JointCounts::default();
        let joints = JointVector::from([0.1, -0.2, f64::INFINITY]);
        let message = usual.to_message([joints, JointVector::default()]);
        let message = message.unwrap();
        assert!(usual.of_message(&message).eq([joints, [0.0; 3].into()]));
        let expected = [[0.1, -0.2, f64::INFINITY], [0.0; 3]];
        assert_eq!(message, expected.map(|[x, y, z]| Vector3 { x, y, z }));
        assert_eq!(usual.vectors(2), 2);
        let error = usual.to_message([JointVector::zeros(4)]).unwrap_err();
        assert_eq!(
            error.to_string(),
            "expected at most 3 joints per finger, got 4"
        );
    }

    #[test]
    fn unused_components_and_missing_vectors_are_rejected() {
        let counts = JointCounts::new([4, 1]);
        let vector = |x, y, z| Vector3 { x, y, z };
        let mut message = vec![
            vector(1.0, 2.0, 3.0),
            vector(4.0, 0.0, 0.0),
            vector(5.0, 0.0, 0.0),
        ];
        assert_eq!(counts.check(2, &message), Ok(()));
        assert!(
            counts
                .of_message(&message)
                .eq([[1.0, 2.0, 3.0, 4.0].into(), JointVector::from([5.0])])
        );
        for unused in [1e-300, f64::NAN] {
            message[1].z = unused;
            assert_eq!(counts.check(2, &message), Err(Rejection::Size));
        }
        message[1].z = 0.0;
        for length in [0, 1, 2] {
            let cut = &message[..length];
            assert_eq!(counts.check(2, cut), Err(Rejection::Size));
            assert_eq!(counts.of_message(cut).count(), length / 2);
        }
        message.push(vector(0.0, 0.0, 0.0));
        assert_eq!(counts.check(2, &message), Err(Rejection::Size));
    }

    proptest! {
        #[test]
        fn every_hand_is_restored(hand in prop::collection::vec(prop::collection::vec(-9.0..9.0, 1..=MAX_JOINTS), 1..=5)) {
            let counts = JointCounts::new(hand.iter().map(Vec::len));
            let joints: Vec<_> = hand.iter().filter_map(|j| JointVector::from_slice(j)).collect();
            let message = counts.to_message(joints.iter().copied()).unwrap();
            prop_assert_eq!(counts.check(hand.len(), &message), Ok(()));
            let lengths = counts.of_message(&message).map(|joints| joints.len());
            prop_assert!(lengths.eq(hand.iter().map(Vec::len)));
            prop_assert!(counts.of_message(&message).eq(joints));
        }
    }
}
