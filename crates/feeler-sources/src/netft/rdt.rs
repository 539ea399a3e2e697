//! Wire format of RDT. All numbers are big-endian.

/// UDP port of the sensor.
pub const RDT_PORT: u16 = 49152;

/// First bytes of a request.
const HEADER: u16 = 0x1234;
/// Length of a request (bytes).
const REQUEST: usize = 8;
/// Length of a record (bytes).
const RECORD: usize = 36;
/// Status bit that indicates a fault.
const ERROR: u32 = 1 << 31;

/// Command of a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    /// Stop sending.
    Stop,
    /// Send records as they are measured.
    Stream,
    /// Use the present load as zero.
    Bias,
}

/// A request to a sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Request {
    /// Command.
    pub command: Command,
    /// Number of records to send; 0 for an endless stream.
    pub count: u32,
}

/// Error of parsing a datagram.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum RdtError {
    /// The datagram has the wrong length.
    #[error("expected a datagram of {expected} bytes, got {actual}")]
    Length {
        /// Expected length, bytes.
        expected: usize,
        /// Actual length, bytes.
        actual: usize,
    },
    /// A request has the wrong header.
    #[error("expected a request with header {HEADER:#06x}, got {actual:#06x}")]
    Header {
        /// Received header.
        actual: u16,
    },
    /// A request has an unknown command.
    #[error("expected command 0 (stop), 2 (stream) or 0x42 (bias), got {actual:#06x}")]
    Command {
        /// Received command.
        actual: u16,
    },
}

impl Request {
    /// Encodes the request.
    pub fn to_bytes(self) -> [u8; REQUEST] {
        let command: u16 = match self.command {
            Command::Stop => 0x0000,
            Command::Stream => 0x0002,
            Command::Bias => 0x0042,
        };
        let mut bytes = [0; REQUEST];
        bytes[..2].copy_from_slice(&HEADER.to_be_bytes());
        bytes[2..4].copy_from_slice(&command.to_be_bytes());
        bytes[4..].copy_from_slice(&self.count.to_be_bytes());
        bytes
    }

    /// Decodes a request.
    ///
    /// # Errors
    /// If length, header or command is invalid.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, RdtError> {
        let words: [u8; REQUEST] = exact(bytes)?;
        let [a, b, c, d, e, f, g, h] = words;
        let (header, command) = (u16::from_be_bytes([a, b]), u16::from_be_bytes([c, d]));
        if header != HEADER {
            return Err(RdtError::Header { actual: header });
        }
        let command = match command {
            0x0000 => Command::Stop,
            0x0002 => Command::Stream,
            0x0042 => Command::Bias,
            actual => return Err(RdtError::Command { actual }),
        };
        let count = u32::from_be_bytes([e, f, g, h]);
        Ok(Self { command, count })
    }
}

/// One sample of a sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Record {
    /// Number of the record since the request; wraps.
    pub rdt_sequence: u32,
    /// Number of the sensor's internal sample; wraps.
    pub ft_sequence: u32,
    /// Status word, see [`Record::is_faulty`].
    pub status: u32,
    /// Forces along x, y, z and torques about them, in counts.
    pub counts: [i32; 6],
}

impl Record {
    /// Encodes the record.
    pub fn to_bytes(self) -> [u8; RECORD] {
        let mut bytes = [0; RECORD];
        let head = [self.rdt_sequence, self.ft_sequence, self.status];
        let counts = self.counts.map(i32::cast_unsigned);
        for (place, word) in bytes
            .chunks_exact_mut(4)
            .zip(head.into_iter().chain(counts))
        {
            place.copy_from_slice(&word.to_be_bytes());
        }
        bytes
    }

    /// Decodes a record.
    ///
    /// # Errors
    /// If the length is wrong.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, RdtError> {
        let bytes: [u8; RECORD] = exact(bytes)?;
        let word = |index: usize| {
            let [a, b, c, d] = [0, 1, 2, 3].map(|byte| bytes[4 * index + byte]);
            u32::from_be_bytes([a, b, c, d])
        };
        Ok(Self {
            rdt_sequence: word(0),
            ft_sequence: word(1),
            status: word(2),
            counts: [3, 4, 5, 6, 7, 8].map(|index| word(index).cast_signed()),
        })
    }

    /// Returns whether the sensor reports invalid readings: saturation, a broken strain gauge or missing power.
    pub fn is_faulty(&self) -> bool {
        self.status & ERROR != 0
    }
}

fn exact<const N: usize>(bytes: &[u8]) -> Result<[u8; N], RdtError> {
    bytes.try_into().map_err(|_| RdtError::Length {
        expected: N,
        actual: bytes.len(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The manual's example of an endless stream request, and a record encoded by hand.
    #[test]
    fn encoding_matches_the_manual() {
        let request = Request {
            command: Command::Stream,
            count: 0,
        };
        assert_eq!(request.to_bytes(), [0x12, 0x34, 0, 2, 0, 0, 0, 0]);
        let mut bytes = [0; 36];
        bytes[3] = 7;
        bytes[7] = 9;
        bytes[8] = 0x80;
        bytes[12..16].copy_from_slice(&[0xff, 0xff, 0xff, 0xfe]);
        bytes[35] = 3;
        let record = Record::from_bytes(&bytes).unwrap();
        assert_eq!((record.rdt_sequence, record.ft_sequence), (7, 9));
        assert_eq!(record.counts, [-2, 0, 0, 0, 0, 3]);
        assert!(record.is_faulty());
        assert_eq!(record.to_bytes(), bytes);
    }

    proptest! {
        #[test]
        fn any_bytes_are_decoded_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..64)) {
            if let Ok(record) = Record::from_bytes(&bytes) {
                prop_assert_eq!(&record.to_bytes()[..], &bytes[..]);
            } else {
                prop_assert_ne!(bytes.len(), RECORD);
            }
            if let Ok(request) = Request::from_bytes(&bytes) {
                prop_assert_eq!(&request.to_bytes()[..], &bytes[..]);
            }
        }
    }
}
