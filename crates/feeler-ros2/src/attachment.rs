//! What stands beside a message: its number, its time and who sent it.

/// Who sent a message: 16 bytes, made of his liveliness token.
pub type Gid = [u8; 16];

/// What stands beside a message.
///
/// The form is that of `rmw_zenoh` since 0.2.4 (Jazzy) and in Kilted and Lyrical. Earlier ones of Jazzy had a form of 77 bytes with the
/// fields' names, and end the program where they find another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Attachment {
    /// Number of the message among its sender's, or of the request.
    pub sequence: i64,
    /// When it was sent, ns since 1970.
    pub stamp_ns: i64,
    /// Who sent it.
    pub gid: Gid,
}

/// Bytes of an [`Attachment`].
pub const BYTES: usize = 33;
/// Bytes of the form that old releases have.
const OLD_BYTES: usize = 77;
/// What stands before the sender: how long it is.
const GID_BYTES: u8 = 16;

/// Why an attachment could not be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum AttachmentError {
    /// It is of a release that is not supported.
    #[error(
        "attachment: {BYTES} bytes expected, found {OLD_BYTES}: its sender has rmw_zenoh 0.2.0 to 0.2.3, which is not supported; update it"
    )]
    Old,
    /// It has another length.
    #[error("attachment: {BYTES} bytes expected, found {0}")]
    Length(usize),
    /// Who sent it has another length.
    #[error("attachment: a source id of {GID_BYTES} bytes expected, found {0}")]
    Gid(u8),
}

impl Attachment {
    /// Its bytes.
    pub fn encode(&self) -> [u8; BYTES] {
        let mut bytes = [GID_BYTES; BYTES];
        bytes[..8].copy_from_slice(&self.sequence.to_le_bytes());
        bytes[8..16].copy_from_slice(&self.stamp_ns.to_le_bytes());
        bytes[17..].copy_from_slice(&self.gid);
        bytes
    }

    /// Reads its bytes.
    ///
    /// # Errors
    /// What is wrong with `bytes`.
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
    fn bytes_are_those_of_rmw_zenoh() {
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
    fn other_lengths_are_refused_and_the_old_form_named() {
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
