//! Serialization of joint quantities: three numbers as an array of fixed length, any other number as a list. An empty
//! vector counts as three zeros.

use feeler::hand::JointVector;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Serializes three numbers as in [`Joints`](super::channels::Joints), others as in
/// [`ChainJoints`](super::chain::ChainJoints).
pub fn serialize<S: Serializer>(joints: &JointVector, serializer: S) -> Result<S::Ok, S::Error> {
    match joints.len() {
        0 | 3 => [joints[0], joints[1], joints[2]].serialize(serializer),
        _ => joints.as_slice().serialize(serializer),
    }
}

/// Deserializes three numbers.
pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<JointVector, D::Error> {
    <[f64; 3]>::deserialize(deserializer).map(JointVector::from)
}
