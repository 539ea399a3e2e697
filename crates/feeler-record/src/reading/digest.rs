//! Digests of recordings: equal digests mean equal runs.

use sha2::{Digest as _, Sha256};
use std::fmt::{self, Write as _};

/// SHA-256 of a recording's content, as 64 hexadecimal digits.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Digest(String);

impl Digest {
    /// The 64 hexadecimal digits.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// Computes the digest of a recording's content in the order of the recording.
///
/// Every text and message is preceded by its length, so that different contents cannot yield the same byte stream.
#[derive(Clone, Default)]
pub struct Digester(Sha256);

impl Digester {
    /// Appends a text or a block of bytes.
    pub fn block(&mut self, bytes: &[u8]) {
        self.0.update((bytes.len() as u64).to_le_bytes());
        self.0.update(bytes);
    }

    /// Appends a message: topic, log time (ns), bytes.
    pub fn message(&mut self, topic: &str, log_time: u64, bytes: &[u8]) {
        self.block(topic.as_bytes());
        self.0.update(log_time.to_le_bytes());
        self.block(bytes);
    }

    /// Returns the digest of everything appended.
    pub fn finish(self) -> Digest {
        let mut text = String::with_capacity(64);
        for byte in self.0.finalize() {
            // Writing to a String cannot fail.
            let _ = write!(text, "{byte:02x}");
        }
        Digest(text)
    }
}
