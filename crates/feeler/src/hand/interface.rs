//! Interface between the controller and a simulated, recorded or real hand.

use super::joint_vector::JointVector;

/// Maximum number of fingers of a hand.
pub const MAX_FINGERS: usize = 5;

/// Joint positions and velocities of one finger, measured by encoders.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointState {
    /// Joint positions (rad or m), from the base to the fingertip. Empty before the first reading, which counts as
    /// zeros.
    pub position: JointVector,
    /// Joint velocities (rad/s or m/s).
    pub velocity: JointVector,
}

impl JointState {
    /// Returns the state of a finger with `joints` joints at joint positions 0, at rest.
    pub fn zero(joints: usize) -> Self {
        Self {
            position: JointVector::zeros(joints),
            velocity: JointVector::zeros(joints),
        }
    }
}

/// Efforts of the drives of one finger: torques (N·m) of revolute joints and forces (N) of prismatic joints, estimated
/// from motor currents. Empty if the drives do not measure currents.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointEfforts {
    /// Effort on each joint by its motor, positive if it increases the joint's position. NaN if unknown.
    pub effort: JointVector,
    /// Uncertainty of each effort due to calibration and friction, which may act in either direction.
    pub uncertainty: JointVector,
}

/// A motor that moves joints of two fingers, such as both jaws of a gripper. Its [effort](JointEfforts) is stated
/// as if only the first joint were loaded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointCoupling {
    /// Finger and joint to which the effort of the motor refers.
    pub first: (usize, usize),
    /// Finger and joint that the motor also moves.
    pub other: (usize, usize),
    /// Motion of the other joint (rad or m) per motion of the first one (rad or m).
    pub ratio: f64,
}

/// Encoder readings of all fingers at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct HandState {
    /// Time of the reading (s).
    pub stamp: f64,
    /// Readings, one per finger.
    pub joints: Vec<JointState>,
    /// Efforts of the drives, one per finger. Empty if the hand does not measure them.
    pub efforts: Vec<JointEfforts>,
}

impl HandState {
    /// Returns the state of `fingers` fingers at time 0, with empty joint vectors, which count as zeros.
    pub fn zero(fingers: usize) -> Self {
        Self {
            stamp: 0.0,
            joints: vec![JointState::default(); fingers],
            efforts: vec![JointEfforts::default(); fingers],
        }
    }
}

/// Joint velocities of all fingers, in effect until the next command.
///
/// Only the controller can create a command that moves a finger, and only with velocities that have passed the limits.
/// Other code can only [`stop`](Self::stop) the hand or [`relay`](Self::relay) the command of a hand program that runs
/// elsewhere.
///
/// ```compile_fail,E0451
/// use feeler::hand::{HandCommand, JointVector};
/// let command = HandCommand { joint_velocity: vec![JointVector::splat(3, 1.0)] };
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct HandCommand {
    joint_velocity: Vec<JointVector>,
}

impl HandCommand {
    /// Returns the command that stops all `fingers` fingers.
    pub fn stop(fingers: usize) -> Self {
        Self {
            joint_velocity: vec![JointVector::default(); fingers],
        }
    }

    /// Joint velocities of each finger, from the base to the fingertip (rad/s or m/s). Empty for a finger that must
    /// stop, which counts as zeros.
    pub fn joint_velocity(&self) -> &[JointVector] {
        &self.joint_velocity
    }

    /// Turns this command into a stop command for the same number of fingers.
    pub fn set_to_stop(&mut self) {
        self.joint_velocity.fill(JointVector::default());
    }

    /// Copies the joint velocities (rad/s) of a command from a remote hand program, whose controller has already
    /// limited them. Fingers that are missing in `joint_velocity` stop. For the process that controls the drives. Does
    /// not allocate.
    pub fn relay(&mut self, joint_velocity: &[JointVector]) {
        self.set_to_stop();
        for (own, &relayed) in self.joint_velocity.iter_mut().zip(joint_velocity) {
            *own = relayed;
        }
    }

    /// Mutable access to the velocities, for the controller, which writes the limited ones.
    pub(crate) fn admitted_mut(&mut self) -> &mut [JointVector] {
        &mut self.joint_velocity
    }
}

/// Error of reading or commanding a hand.
#[derive(Debug, thiserror::Error)]
pub enum HandError {
    /// The state or command has a different number of fingers than the hand.
    #[error("the hand has {expected} fingers, the state or command has {actual}")]
    FingerCount {
        /// Number of fingers of the hand.
        expected: usize,
        /// Number of fingers of the state or command.
        actual: usize,
    },
    /// A finger has more joints than the hand supports.
    #[error("expected at most {expected} joints per finger, got {actual}")]
    JointCount {
        /// Maximum number of joints per finger.
        expected: usize,
        /// Number of joints in the state or command.
        actual: usize,
    },
    /// The hand has failed.
    #[error("{0}")]
    Failed(String),
    /// The recording has no further states.
    #[error("no hand state after the {count} on record")]
    Ended {
        /// Number of states in the recording.
        count: u64,
    },
}

/// Checks that the number of fingers in a state or command equals that of the hand.
///
/// # Errors
/// If `actual` differs from `expected`.
pub fn check_finger_count(expected: usize, actual: usize) -> Result<(), HandError> {
    if actual == expected {
        Ok(())
    } else {
        Err(HandError::FingerCount { expected, actual })
    }
}

/// Interface to a hand with velocity-controlled fingers.
pub trait Hand {
    /// Number of fingers.
    fn finger_count(&self) -> usize;

    /// Fills `state` with the latest encoder readings.
    ///
    /// # Errors
    /// If `state` has a different number of fingers, or the encoders could not be read.
    fn read(&mut self, state: &mut HandState) -> Result<(), HandError>;

    /// Sends joint velocities to the drives. They are in effect for one control period; a simulated hand advances its
    /// simulation by that period.
    ///
    /// # Errors
    /// If `command` has a different number of fingers, or the drives rejected it.
    fn command(&mut self, command: &HandCommand) -> Result<(), HandError>;
}

/// Forwards to the boxed hand.
impl<H: Hand + ?Sized> Hand for Box<H> {
    fn finger_count(&self) -> usize {
        (**self).finger_count()
    }

    fn read(&mut self, state: &mut HandState) -> Result<(), HandError> {
        (**self).read(state)
    }

    fn command(&mut self, command: &HandCommand) -> Result<(), HandError> {
        (**self).command(command)
    }
}
