//! Conversion of joint quantities from and to messages.

use feeler::hand::{HandError, JointVector};
use feeler_record::wire::Vector3;

/// Number of joints of each finger in a message.
const JOINTS: usize = 3;

/// Converts joint quantities of one finger to those of a message; missing ones are 0.
///
/// # Errors
/// [`HandError::JointCount`] if the finger has more joints than a message can contain.
pub fn joints_to_message(joints: JointVector) -> Result<Vector3, HandError> {
    let (expected, actual) = (JOINTS, joints.len());
    let error = HandError::JointCount { expected, actual };
    let [x, y, z] = joints.to_array::<JOINTS>().ok_or(error)?;
    Ok(Vector3 { x, y, z })
}

/// Converts joint quantities of one finger in a message.
pub fn joints_of_message(joints: Vector3) -> JointVector {
    JointVector::from([joints.x, joints.y, joints.z])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_joints_keep_their_numbers_and_more_are_refused() {
        let joints = JointVector::from([0.1, -0.2, f64::INFINITY]);
        let message = joints_to_message(joints).unwrap();
        assert_eq!(joints_of_message(message), joints);
        let stopped = joints_to_message(JointVector::default()).unwrap();
        assert_eq!((stopped.x, stopped.y, stopped.z), (0.0, 0.0, 0.0));
        let error = joints_to_message(JointVector::zeros(4)).unwrap_err();
        assert_eq!(
            error.to_string(),
            "expected at most 3 joints per finger, got 4"
        );
    }
}
