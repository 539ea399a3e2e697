//! Why a GenICam camera cannot be used.

/// Why a camera cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum GenicamError {
    /// Aravis is not there.
    #[error(
        "GenICam cameras need the library Aravis 0.8: {reason}; install it (Debian, Ubuntu: apt install libaravis-0.8-0)"
    )]
    Library {
        /// What the system said.
        reason: String,
    },
    /// There is no such camera.
    #[error(
        "genicam:{id}: no such camera ({reason}); expected one of those that `feeler cameras` lists: {listed}"
    )]
    NotFound {
        /// Which was asked for; empty for the first.
        id: String,
        /// What Aravis said.
        reason: String,
        /// Those that are there.
        listed: String,
    },
    /// The camera cannot be set as is asked for.
    #[error("{camera}: {what}: {reason}")]
    Setting {
        /// The camera.
        camera: String,
        /// What was to be set.
        what: String,
        /// What is missing or out of range.
        reason: String,
    },
    /// The camera does not do what it must.
    #[error("{camera}: {what}: {reason}; expected a GenICam camera that nobody else uses")]
    Device {
        /// The camera.
        camera: String,
        /// What was tried.
        what: &'static str,
        /// What Aravis said.
        reason: String,
    },
}
