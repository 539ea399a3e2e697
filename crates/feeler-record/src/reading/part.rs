//! Reading of a recording in parts.

use super::recording::Recording;

/// Number of messages in a part of a recording: half a second to a few seconds.
pub const PART: usize = 2_000;

/// Callback with the recording so far and the position in the file, in bytes.
pub(crate) type Part<'a> = dyn FnMut(&mut Recording, u64) + 'a;
