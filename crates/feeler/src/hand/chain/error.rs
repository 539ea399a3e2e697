//! Errors of the configuration of a chain.

/// Error returned for an invalid [`ChainConfig`](super::ChainConfig).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ChainError {
    /// A value is not finite or out of its range.
    #[error("{field} = {value}: expected {expected}")]
    OutOfRange {
        /// Field of the configuration.
        field: String,
        /// The rejected value.
        value: f64,
        /// Description of the valid values.
        expected: &'static str,
    },
    /// The upper limit of a joint is not above its lower limit.
    #[error("joints[{index}].upper = {upper}: expected more than joints[{index}].lower = {lower}")]
    JointLimits {
        /// Index of the joint, from 0.
        index: usize,
        /// Lower limit of the joint (rad or m).
        lower: f64,
        /// Upper limit of the joint (rad or m).
        upper: f64,
    },
    /// A list has too few or too many entries.
    #[error("expected {expected} {field}, got {count}")]
    Count {
        /// Name of the list.
        field: &'static str,
        /// Number of entries.
        count: usize,
        /// Description of the valid numbers.
        expected: &'static str,
    },
    /// The configuration has rows in both of the tables `dh` and `frames`, or in neither.
    #[error("expected rows in either dh or frames, got {dh} in dh and {frames} in frames")]
    Tables {
        /// Number of rows of `dh`.
        dh: usize,
        /// Number of rows of `frames`.
        frames: usize,
    },
    /// Two joints have the same name, or a joint's name is empty.
    #[error("joints[{index}].name = \"{name}\": expected a name that no other joint has")]
    Name {
        /// Index of the joint, from 0.
        index: usize,
        /// The rejected name.
        name: String,
    },
    /// A row refers to a joint that is not listed.
    #[error("{field} = \"{name}\": expected one of the joints {known}")]
    UnknownJoint {
        /// Field of the configuration.
        field: String,
        /// The rejected name.
        name: String,
        /// Names of all joints.
        known: String,
    },
    /// A moving row has both `joint` and `mimic` or neither of them, or a fixed row has one of them.
    #[error("{field}: expected {expected}")]
    Driver {
        /// Name of the row.
        field: String,
        /// Description of a valid row.
        expected: &'static str,
    },
    /// A joint does not drive any row.
    #[error("expected a row that joint \"{name}\" drives, got none")]
    UnusedJoint {
        /// Name of the joint.
        name: String,
    },
}
