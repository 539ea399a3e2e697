//! Reasons for stopping a hand before its task is done.

use crate::hand::JointCoupling;

/// Reason for stopping a hand before its task was done.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StopReason {
    /// A finger found no object within its maximum travel.
    #[error("finger {finger} travelled {travel:.4} m from home without a grasp (limit {limit} m)")]
    NothingToGrasp {
        /// Index of the finger.
        finger: usize,
        /// Distance that the finger has moved from home (m).
        travel: f64,
        /// Maximum distance (m).
        limit: f64,
    },
    /// A finger lost contact with the object during the task.
    #[error(
        "finger {finger} lost contact while it sheared or slid: expected an object that extends along its axis as far as the finger slides"
    )]
    ContactLost {
        /// Index of the finger.
        finger: usize,
    },
    /// The input has a different number of fingers than the hand.
    #[error("expected {what} of {expected} fingers, got {actual}")]
    FingerCount {
        /// Name of the input.
        what: &'static str,
        /// Number of fingers of the hand.
        expected: usize,
        /// Number of fingers in the input.
        actual: usize,
    },
    /// A tactile frame has a different number of elements than its finger.
    #[error("expected forces on {expected} elements of finger {finger}, got {actual}")]
    ElementCount {
        /// Index of the finger.
        finger: usize,
        /// Number of elements of the finger.
        expected: usize,
        /// Number of elements in the tactile frame.
        actual: usize,
    },
    /// The joint state of a finger has a different number of joints than the finger.
    #[error("expected {expected} joints of finger {finger}, got {actual}")]
    JointCount {
        /// Index of the finger.
        finger: usize,
        /// Number of joints of the finger.
        expected: usize,
        /// Number of joints in the joint state.
        actual: usize,
    },
    /// A tactile sensor or the hand's encoders could not be read.
    #[error("{what} could not be read")]
    ReadFailed {
        /// Name of the device that could not be read.
        what: &'static str,
    },
    /// The forces of a finger are too old, or their stamp is in the future.
    #[error("the forces of finger {finger} are {age:.4} s old (limit {limit} s)")]
    StaleForces {
        /// Index of the finger.
        finger: usize,
        /// Age of the latest tactile frame (s), negative if its stamp is in the future.
        age: f64,
        /// Maximum age (s).
        limit: f64,
    },
    /// The joint angles are too old, or have not been received.
    #[error("the joint angles are {age:.4} s old (limit {limit} s)")]
    StaleState {
        /// Age of the latest joint angles (s).
        age: f64,
        /// Maximum age (s).
        limit: f64,
    },
    /// The force on an element is unknown: its sub-region is dark or saturated, or its value is not a number.
    #[error(
        "element {element} of finger {finger} has no valid force: its sub-region is dark or saturated, or its force is not a number"
    )]
    NoForce {
        /// Index of the finger.
        finger: usize,
        /// Index of the first such element.
        element: usize,
    },
    /// New images repeatedly give bit-identical forces, which indicates a stuck camera because of the noise of a
    /// working one.
    #[error(
        "the last {frames} images of finger {finger} gave forces identical to those before: its camera is frozen (for a sensor without noise, set control.monitor.frozen_frames = 0)"
    )]
    StuckSensorDetector {
        /// Index of the finger.
        finger: usize,
        /// Number of consecutive frames with unchanged forces.
        frames: u32,
    },
    /// A joint angle is far outside the joint's limits.
    #[error(
        "joint {joint} of finger {finger} reads {angle:.4} {unit}, far beyond its limits of {lower:.4} to {upper:.4} {unit}"
    )]
    JointOutOfRange {
        /// Index of the finger.
        finger: usize,
        /// Index of the joint; theta1 is joint 0.
        joint: usize,
        /// Measured position (rad or m).
        angle: f64,
        /// Lower limit (rad or m).
        lower: f64,
        /// Upper limit (rad or m).
        upper: f64,
        /// Unit of the joint's position: `rad` or `m`.
        unit: &'static str,
    },
    /// A joint angle changed faster than the joint can move.
    #[error(
        "joint {joint} of finger {finger} jumped by {turn:.4} {unit} within {elapsed:.4} s (limit {limit:.4} {unit})"
    )]
    JointJump {
        /// Index of the finger.
        finger: usize,
        /// Index of the joint; theta1 is joint 0.
        joint: usize,
        /// Change of the joint's position between two readings (rad or m).
        turn: f64,
        /// Time between the readings (s).
        elapsed: f64,
        /// Maximum possible change (rad or m).
        limit: f64,
        /// Unit of the joint's position: `rad` or `m`.
        unit: &'static str,
    },
    /// A joint did not follow its commands.
    #[error(
        "joint {joint} of finger {finger} moved by {turn:.4} {unit} within {time:.2} s where {expected:.4} {unit} was commanded: its sensor or drive has failed, or it is blocked{}",
        deviation(*shared)
    )]
    JointDeviation {
        /// Index of the finger.
        finger: usize,
        /// Index of the joint; theta1 is joint 0.
        joint: usize,
        /// Measured motion (rad or m).
        turn: f64,
        /// Closest motion that agrees with the commands and the drives' lag (rad or m).
        expected: f64,
        /// Duration of the motion (s).
        time: f64,
        /// Unit of the joint's position: `rad` or `m`.
        unit: &'static str,
        /// `true` if the motor also moves joints of other fingers.
        shared: bool,
    },
    /// The effort of a joint's motor contradicts the forces measured by the fingertip.
    #[error(
        "the motor of joint {joint} of finger {finger} exerts {effort:.3}, but {} require {felt:.3} {unit} (tolerance {tolerance:.3} {unit}): {}",
        mismatch(*shared).0,
        mismatch(*shared).1
    )]
    EffortMismatch {
        /// Index of the finger.
        finger: usize,
        /// Index of the joint; theta1 is joint 0.
        joint: usize,
        /// Mean effort of the motor (N m or N).
        effort: f64,
        /// Mean effort that would balance the measured forces (N m or N).
        felt: f64,
        /// Maximum allowed difference (N m or N).
        tolerance: f64,
        /// Unit of the efforts: `N m`, or `N` of a prismatic joint.
        unit: &'static str,
        /// `true` if the motor also moves joints of other fingers, whose forces are then included.
        shared: bool,
    },
    /// The compression of an element exceeds the limit.
    #[error("element {element} of finger {finger} is pressed with {force:.2} N (limit {limit} N)")]
    Overload {
        /// Index of the finger.
        finger: usize,
        /// Index of the first such element.
        element: usize,
        /// Compression of the element (N).
        force: f64,
        /// Maximum compression (N).
        limit: f64,
    },
    /// The task cannot continue.
    #[error("the task gave up: {reason}")]
    TaskFailed {
        /// Reason given by the task.
        reason: String,
    },
    /// An operator or a program requested the stop.
    #[error("stop requested by {by}")]
    Requested {
        /// Source of the request.
        by: String,
    },
    /// The control loop missed too many periods, so that the drives kept executing a stale command.
    #[error("the control loop missed {missed} periods in a row (limit {limit})")]
    MissedPeriods {
        /// Number of consecutive periods without a step.
        missed: u64,
        /// Maximum number of missed periods.
        limit: u64,
    },
    /// The recorded hand was stopped at this step by an external request; only in a replay.
    #[error("the recorded hand was stopped by an external request")]
    Recorded,
    /// A force, a joint angle or a command is not a finite number.
    #[error("finger {finger} has a {what} that is not a finite number")]
    NotFinite {
        /// Index of the finger.
        finger: usize,
        /// Name of the affected quantity.
        what: &'static str,
    },
}

/// Names a further cause of a deviation if the motor also moves joints of other fingers.
fn deviation(shared: bool) -> &'static str {
    match shared {
        false => "",
        true => {
            "; its motor follows the slowest of all joints that it moves, and stands still if they are commanded in opposite directions: check their homing offsets, directions and travel with `feeler check`"
        }
    }
}

/// Names the forces that contradict a motor, and possible causes. The motor moves one finger, or several if `shared`.
fn mismatch(shared: bool) -> (&'static str, &'static str) {
    match shared {
        false => (
            "the fingertip's forces",
            "its tactile sensor has failed, or the finger touches something beside its fingertip",
        ),
        true => (
            "the forces on all fingertips that it moves",
            "one of their tactile sensors has failed, or one of these fingers touches something beside its fingertip",
        ),
    }
}

impl StopReason {
    /// Marks the deviation of a joint whose motor also moves a joint of another finger, according to `couplings`.
    pub(super) fn with_couplings(mut self, couplings: &[JointCoupling]) -> Self {
        if let Self::JointDeviation {
            finger,
            joint,
            shared,
            ..
        } = &mut self
        {
            let own = (*finger, *joint);
            let mut moved = couplings.iter().flat_map(|both| [both.first, both.other]);
            *shared = moved.any(|moved| moved == own);
        }
        self
    }

    /// Returns whether stale data caused the stop.
    pub fn is_stale(&self) -> bool {
        matches!(self, Self::StaleForces { .. } | Self::StaleState { .. })
    }

    /// Returns whether an implausible sensor reading caused the stop.
    pub fn is_sensor_fault(&self) -> bool {
        matches!(
            self,
            Self::StuckSensorDetector { .. }
                | Self::JointOutOfRange { .. }
                | Self::JointJump { .. }
                | Self::JointDeviation { .. }
                | Self::EffortMismatch { .. }
        )
    }

    /// Returns whether the hand may resume automatically because the cause can disappear. After a sensor fault, an
    /// operator must check the hand and request to resume.
    pub fn is_recoverable(&self) -> bool {
        self.is_stale()
            || self.is_sensor_fault()
            || matches!(self, Self::NoForce { .. } | Self::Requested { .. })
    }
}
