//! The seam between the hand program and whatever moves: a simulated rig, a recording, real drives.

use glam::DVec3;

/// Most fingers that a hand has.
pub const MAX_FINGERS: usize = 5;

/// What the encoders of one finger say.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointState {
    /// Joint angles theta1..theta3, rad.
    pub position: DVec3,
    /// Joint velocities, rad/s.
    pub velocity: DVec3,
}

/// What the encoders of all fingers say at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct HandState {
    /// Time of the reading, s.
    pub stamp: f64,
    /// One entry per finger.
    pub joints: Vec<JointState>,
}

impl HandState {
    /// `fingers` fingers at joint angles zero and at rest, at time 0.
    pub fn zero(fingers: usize) -> Self {
        Self {
            stamp: 0.0,
            joints: vec![JointState::default(); fingers],
        }
    }
}

/// What the drives of all fingers are to do until the next command.
///
/// A command that moves anything is made in one place, the controller, of what the limits admit:
/// nobody else can write velocities into one. Whoever has no controller can only [`stop`](Self::stop),
/// or [`relay`](Self::relay) the command of a hand program elsewhere.
///
/// ```compile_fail,E0451
/// use feeler::{glam::DVec3, hand::HandCommand};
/// let command = HandCommand { joint_velocity: vec![DVec3::ONE] };
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct HandCommand {
    joint_velocity: Vec<DVec3>,
}

impl HandCommand {
    /// All `fingers` fingers stop.
    pub fn stop(fingers: usize) -> Self {
        Self {
            joint_velocity: vec![DVec3::ZERO; fingers],
        }
    }

    /// Joint velocities theta1..theta3 of each finger, rad/s.
    pub fn joint_velocity(&self) -> &[DVec3] {
        &self.joint_velocity
    }

    /// Makes it a command to stop, for as many fingers as before.
    pub fn set_to_stop(&mut self) {
        self.joint_velocity.fill(DVec3::ZERO);
    }

    /// Makes it the command that came from a hand program elsewhere, whose controller has limited it:
    /// joint velocities of each finger, rad/s. A finger that it says nothing of stops. For the side
    /// that has the drives; does not allocate.
    pub fn relay(&mut self, joint_velocity: &[DVec3]) {
        self.set_to_stop();
        for (own, &relayed) in self.joint_velocity.iter_mut().zip(joint_velocity) {
            *own = relayed;
        }
    }

    /// The velocities, for the controller to put in what the limits admit.
    pub(crate) fn admitted_mut(&mut self) -> &mut [DVec3] {
        &mut self.joint_velocity
    }
}

/// Why a hand could not be read or moved.
#[derive(Debug, thiserror::Error)]
pub enum HandError {
    /// The state or the command is for another number of fingers.
    #[error("the hand has {expected} fingers, the state or command has {actual}")]
    FingerCount {
        /// Fingers of the hand.
        expected: usize,
        /// Fingers of the state or command.
        actual: usize,
    },
    /// The hand cannot go on.
    #[error("{0}")]
    Failed(String),
    /// There is no further state (the end of a recording).
    #[error("no hand state after the {count} on record")]
    Ended {
        /// How many there were.
        count: u64,
    },
}

/// Refuses a state or command for `actual` fingers where the hand has `expected`.
///
/// # Errors
/// When they differ.
pub fn check_finger_count(expected: usize, actual: usize) -> Result<(), HandError> {
    if actual == expected {
        Ok(())
    } else {
        Err(HandError::FingerCount { expected, actual })
    }
}

/// A hand of velocity-controlled fingers.
pub trait Hand {
    /// Number of fingers.
    fn finger_count(&self) -> usize;

    /// Fills `state` with the newest encoder readings.
    ///
    /// # Errors
    /// When `state` is for another number of fingers, or nothing could be read.
    fn read(&mut self, state: &mut HandState) -> Result<(), HandError>;

    /// Sends joint velocities to the drives. They hold for one control period; a simulated hand
    /// advances its world by that period.
    ///
    /// # Errors
    /// When `command` is for another number of fingers, or the drives did not take it.
    fn command(&mut self, command: &HandCommand) -> Result<(), HandError>;
}

/// A hand of whichever kind.
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
