//! Step of decoding a skin's bytes.

/// Next step of decoding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Step {
    /// Wait for more bytes.
    Wait,
    /// Skip this number of bytes, which are not part of a frame.
    Skip(usize),
    /// Return the frame that begins at byte `first`, and continue at byte `end`.
    Frame {
        /// Index of the frame's first byte.
        first: usize,
        /// Number of bytes to remove from the buffer.
        end: usize,
    },
}
