//! Errors of nodes.

use crate::message_text::DescriptionError;
use crate::name::NameError;
use feeler_record::RecordError;
use feeler_record::wire::WireError;

/// Error of a node.
#[derive(Debug, thiserror::Error)]
pub enum NodeError {
    /// A name is invalid.
    #[error(transparent)]
    Name(#[from] NameError),
    /// A message text is invalid.
    #[error(transparent)]
    Description(#[from] DescriptionError),
    /// A message could not be encoded.
    #[error(transparent)]
    Wire(#[from] WireError),
    /// A finger has more joints than a message can contain.
    #[error(transparent)]
    Joints(#[from] RecordError),
    /// Zenoh returned an error.
    #[error("ROS 2 graph: {0}")]
    Zenoh(String),
    /// A service did not respond.
    #[error(
        "{service}: expected a response within {timeout:.3} s, got none; check that its server runs"
    )]
    NoResponse {
        /// Type of the service.
        service: &'static str,
        /// Maximum time (s).
        timeout: f64,
    },
    /// A service returned an error, or an invalid response.
    #[error("{service}: {why}")]
    Refused {
        /// Type of the service.
        service: &'static str,
        /// The server's error message, or the problem of its response.
        why: String,
    },
    /// A thread could not be started.
    #[error("failed to start a thread: {0}")]
    Thread(#[from] std::io::Error),
}

impl From<zenoh::Error> for NodeError {
    fn from(error: zenoh::Error) -> Self {
        Self::Zenoh(error.to_string())
    }
}
