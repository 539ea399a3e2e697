//! Metadata that `rmw_zenoh` attaches to each message: sequence number, time stamp and source.

/// Identifier of a message's source: 16 bytes, derived from its liveliness token.
pub type Gid = [u8; 16];

/// Attachment of a message, service request or response.
///
/// The format matches `rmw_zenoh` in Jazzy since 0.2.4, Kilted and Lyrical. Earlier Jazzy releases use a format of 77
/// bytes that includes field names, and abort if they receive another format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Attachment {
    /// Sequence number of the message or request, counted by its source.
    pub sequence: i64,
    /// Time of sending (ns since 1970).
    pub stamp_ns: i64,
    /// Identifier of the message's source.
    pub gid: Gid,
}

/// Encoded length of an [`Attachment`] in bytes.
pub const BYTES: usize = 33;
/// Length of an attachment from `rmw_zenoh` 0.2.0 to 0.2.3, in bytes.
const OLD_BYTES: usize = 77;
/// Value of the length prefix of the source identifier.
const GID_BYTES: u8 = 16;

/// Error when decoding an [`Attachment`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum AttachmentError {
    /// The attachment has the format of a release that is not supported.
    #[error(
        "attachment: expected {BYTES} bytes, got {OLD_BYTES}; the sender uses rmw_zenoh 0.2.0 to 0.2.3, which is not supported: update it"
    )]
    Old,
    /// The attachment has the wrong length.
    #[error("attachment: expected {BYTES} bytes, got {0}")]
    Length(usize),
    /// The length prefix of the source identifier is wrong.
    #[error("attachment: expected a source id of {GID_BYTES} bytes, got {0}")]
    Gid(u8),
}

impl Attachment {
    /// Encodes the attachment.
    pub fn encode(&self) -> [u8; BYTES] {
        let mut bytes = [GID_BYTES; BYTES];
        bytes[..8].copy_from_slice(&self.sequence.to_le_bytes());
        bytes[8..16].copy_from_slice(&self.stamp_ns.to_le_bytes());
        bytes[17..].copy_from_slice(&self.gid);
        bytes
    }

    /// Decodes an attachment.
    ///
    /// # Errors
    /// If `bytes` are not an attachment of this format.
    pub fn decode(bytes: &[u8]) -> Result<Self, AttachmentError> {
        let wrong = || match bytes.len() {
            OLD_BYTES => AttachmentError::Old,
            other => AttachmentError::Length(other),
        };
        let (sequence, rest) = bytes.split_first_chunk().ok_or_else(wrong)?;
        let (stamp, rest) = rest.split_first_chunk().ok_or_else(wrong)?;
        let (&length, gid) = rest.split_first().ok_or_else(wrong)?;
        let gid = gid.try_into().map_err(|_| wrong())?;
        if length != GID_BYTES {
            return Err(AttachmentError::Gid(length));
        }
        Ok(Self {
            sequence: i64::from_le_bytes(*sequence),
            stamp_ns: i64::from_le_bytes(*stamp),
            gid,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encoding_matches_rmw_zenoh() {
        let gid = std::array::from_fn(|i| i as u8);
        let attachment = Attachment {
            sequence: 0x0102,
            stamp_ns: -1,
            gid,
        };
        let mut expected = vec![2, 1, 0, 0, 0, 0, 0, 0];
        expected.extend([0xff; 8]);
        expected.push(16);
        expected.extend(0..16);
        assert_eq!(attachment.encode()[..], expected);
        assert_eq!(Attachment::decode(&expected), Ok(attachment));
    }

    #[test]
    fn other_lengths_are_rejected_and_the_old_format_is_recognized() {
        for length in (0..100).filter(|length| *length != BYTES) {
            let expected = match length {
                77 => AttachmentError::Old,
                _ => AttachmentError::Length(length),
            };
            assert_eq!(Attachment::decode(&vec![16; length]), Err(expected));
        }
        let mut bytes = [0; BYTES];
        bytes[16] = 15;
        assert_eq!(Attachment::decode(&bytes), Err(AttachmentError::Gid(15)));
    }
}
