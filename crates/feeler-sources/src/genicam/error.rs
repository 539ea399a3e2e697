//! Errors of GenICam cameras.

/// Error of a GenICam camera.
#[derive(Debug, thiserror::Error)]
pub enum GenicamError {
    /// Aravis cannot be loaded.
    #[error(
        "GenICam cameras need the library Aravis 0.8: {reason}; install it (Debian, Ubuntu: apt install libaravis-0.8-0)"
    )]
    Library {
        /// Error of the operating system.
        reason: String,
    },
    /// No camera matches the requested id.
    #[error(
        "genicam:{id}: no such camera ({reason}); expected one of those listed by `feeler cameras`: {listed}"
    )]
    NotFound {
        /// Requested id; empty for the first camera.
        id: String,
        /// Error of Aravis.
        reason: String,
        /// Ids of the available cameras.
        listed: String,
    },
    /// The camera rejects a setting.
    #[error("{camera}: {what}: {reason}")]
    Setting {
        /// Name of the camera.
        camera: String,
        /// The rejected setting.
        what: String,
        /// Reason why the setting is rejected, such as a missing feature or the valid range.
        reason: String,
    },
    /// An operation on the camera failed.
    #[error("{camera}: {what}: {reason}; expected a GenICam camera that no other program uses")]
    Device {
        /// Name of the camera.
        camera: String,
        /// The operation that failed.
        what: &'static str,
        /// Error of Aravis.
        reason: String,
    },
}
