//! Step of decoding a skin's bytes.

/// Next step of decoding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Step {
    /// More bytes are required.
    Wait,
    /// This number of bytes is not part of a frame.
    Skip(usize),
    /// A frame begins at byte `first`, and decoding continues at byte `end`.
    Frame {
        /// Index of the frame's first byte.
        first: usize,
        /// Number of bytes to remove.
        end: usize,
    },
}
