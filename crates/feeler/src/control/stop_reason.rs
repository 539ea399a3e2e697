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
    /// An element's force is unknown: its sub-region is dark or saturated.
    #[error(
        "element {element} of finger {finger} has no valid force: its sub-region is dark or saturated"
    )]
    NoForce {
        /// The finger.
        finger: usize,
        /// The first such element.
        element: usize,
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

    /// Whether its cause may go away while the hand waits, so that it can go on.
    pub fn may_pass(&self) -> bool {
        self.is_stale() || matches!(self, Self::NoForce { .. } | Self::Told { .. })
    }
}
