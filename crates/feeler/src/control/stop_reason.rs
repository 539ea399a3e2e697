//! Why a hand stops before its task is done.

/// Why the hand was stopped before the task was done.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StopReason {
    /// A finger found nothing to grasp.
    #[error("finger {finger} came {travel:.4} m from home without a grasp (limit {limit} m)")]
    NothingToGrasp {
        /// The finger.
        finger: usize,
        /// How far it came, m.
        travel: f64,
        /// How far it was to come at most, m.
        limit: f64,
    },
    /// A finger has lost the object that it pressed.
    #[error(
        "finger {finger} lost the object while it sheared or slid: expected an object that reaches as far along its axis as the finger slides"
    )]
    ContactLost {
        /// The finger.
        finger: usize,
    },
    /// What arrived is for another number of fingers.
    #[error("the hand has {expected} fingers, the {what} that arrived are of {actual}")]
    FingerCount {
        /// What arrived.
        what: &'static str,
        /// Fingers of the hand.
        expected: usize,
        /// Fingers that it was for.
        actual: usize,
    },
    /// A tactile frame is for another number of elements.
    #[error("finger {finger} has {expected} elements, its forces are of {actual}")]
    ElementCount {
        /// The finger.
        finger: usize,
        /// Its elements.
        expected: usize,
        /// Elements of the tactile frame.
        actual: usize,
    },
    /// A finger's sensor or the hand's encoders could not be read.
    #[error("{what} could not be read")]
    ReadFailed {
        /// What could not be read.
        what: &'static str,
    },
    /// A finger's forces are too old to act on, or from a time to come.
    #[error("the forces of finger {finger} are {age:.4} s old (limit {limit} s)")]
    StaleForces {
        /// The finger.
        finger: usize,
        /// Age of its newest tactile frame, s; negative when that is from a time to come.
        age: f64,
        /// Greatest age allowed, s.
        limit: f64,
    },
    /// The joint angles are too old to act on, or none have arrived.
    #[error("the joint angles are {age:.4} s old (limit {limit} s)")]
    StaleState {
        /// Age of the newest, s.
        age: f64,
        /// Greatest age allowed, s.
        limit: f64,
    },
    /// An element's force is unknown: its sub-region is dark or saturated, or what was measured is no number.
    #[error(
        "element {element} of finger {finger} has no valid force: its sub-region is dark or saturated, or its force is no number"
    )]
    NoForce {
        /// The finger.
        finger: usize,
        /// The first such element.
        element: usize,
    },
    /// New pictures go on giving the same forces to the bit, which noise never does.
    #[error(
        "the newest {frames} pictures of finger {finger} gave the same forces to the bit as the one before: its camera is frozen (a sensor without noise needs control.monitor.frozen_frames = 0)"
    )]
    FrozenForces {
        /// The finger.
        finger: usize,
        /// New frames that were the same as the one before.
        frames: u32,
    },
    /// A joint is where it cannot be.
    #[error(
        "joint {joint} of finger {finger} reads {angle:.4} rad, far beyond its limits of {lower:.4} to {upper:.4} rad"
    )]
    JointOutOfRange {
        /// The finger.
        finger: usize,
        /// The joint: theta1 is joint 0.
        joint: usize,
        /// Its angle as read, rad.
        angle: f64,
        /// Its lower limit, rad.
        lower: f64,
        /// Its upper limit, rad.
        upper: f64,
    },
    /// A joint turned faster than it can.
    #[error(
        "joint {joint} of finger {finger} jumped by {turn:.4} rad within {elapsed:.4} s: it can turn by {limit:.4} rad at most"
    )]
    JointJump {
        /// The finger.
        finger: usize,
        /// The joint: theta1 is joint 0.
        joint: usize,
        /// By how much it turned between two readings, rad.
        turn: f64,
        /// Time between them, s.
        elapsed: f64,
        /// By how much it can have turned, rad.
        limit: f64,
    },
    /// A joint did not turn as it was told.
    #[error(
        "joint {joint} of finger {finger} turned by {turn:.4} rad within {time:.2} s where {expected:.4} rad was commanded: its sensor or its drive fails, or something blocks it"
    )]
    JointDeviation {
        /// The finger.
        finger: usize,
        /// The joint: theta1 is joint 0.
        joint: usize,
        /// By how much it turned by its sensor, rad.
        turn: f64,
        /// What it was told, as near to that as the drives' lag allows, rad.
        expected: f64,
        /// Time in which it did, s.
        time: f64,
    },
    /// An element is pressed harder than the limits allow.
    #[error("element {element} of finger {finger} is pressed with {force:.2} N (limit {limit} N)")]
    Overload {
        /// The finger.
        finger: usize,
        /// The first such element.
        element: usize,
        /// Its compression, N.
        force: f64,
        /// The limit, N.
        limit: f64,
    },
    /// The task cannot go on, for a reason of its own.
    #[error("the task gave up: {reason}")]
    TaskFailed {
        /// Why.
        reason: String,
    },
    /// Somebody said so.
    #[error("told to stop by {by}")]
    Told {
        /// Who.
        by: String,
    },
    /// The control loop came round too late: the drives went on with an old command meanwhile.
    #[error("the control loop missed {missed} periods in a row (limit {limit})")]
    MissedPeriods {
        /// Whole periods without a step.
        missed: u64,
        /// How many may be missed.
        limit: u64,
    },
    /// In a replay: somebody stopped the hand at this step on record.
    #[error("it was stopped from outside the control law on record")]
    OnRecord,
    /// A force, a joint angle or a command is not a finite number.
    #[error("finger {finger} has a {what} that is not a finite number")]
    NotFinite {
        /// The finger.
        finger: usize,
        /// Which quantity.
        what: &'static str,
    },
}

impl StopReason {
    /// Whether it came of data that were too old.
    pub fn is_stale(&self) -> bool {
        matches!(self, Self::StaleForces { .. } | Self::StaleState { .. })
    }

    /// Whether a sensor said what cannot be true.
    pub fn is_sensor_fault(&self) -> bool {
        matches!(
            self,
            Self::FrozenForces { .. }
                | Self::JointOutOfRange { .. }
                | Self::JointJump { .. }
                | Self::JointDeviation { .. }
        )
    }

    /// Whether its cause may go away while the hand waits, so that it can go on; after a sensor fault only when somebody
    /// has looked and says so.
    pub fn may_pass(&self) -> bool {
        self.is_stale()
            || self.is_sensor_fault()
            || matches!(self, Self::NoForce { .. } | Self::Told { .. })
    }
}
