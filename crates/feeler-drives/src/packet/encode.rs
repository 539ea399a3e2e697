//! From what a packet says to its bytes.

use super::{Protocol, check};

/// Most bytes of a Dynamixel packet after its length, which keeps buffers small: more than any servo of a hand sends.
pub const LONGEST: usize = 1024;

/// A packet would be longer than its protocol or a servo's buffer allows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a packet of {actual} bytes after its length: expected at most {limit}")]
pub struct TooLong {
    /// Bytes after the length.
    pub actual: usize,
    /// How many there may be.
    pub limit: usize,
}

/// Writes a packet into `bytes`, in place of what is there. `code` is the instruction; of a servo's answer
/// [`STATUS`](super::instruction::STATUS), with the error byte as first parameter, or, in Feetech's protocol, the status
/// itself. Does not allocate where `bytes` has room.
///
/// # Errors
/// When the parameters are too many.
pub fn encode(
    protocol: Protocol,
    (id, code): (u8, u8),
    parameters: &[u8],
    bytes: &mut Vec<u8>,
) -> Result<(), TooLong> {
    bytes.clear();
    match protocol {
        Protocol::Dynamixel => dynamixel((id, code), parameters, bytes),
        Protocol::Feetech => feetech((id, code), parameters, bytes),
    }
}

fn dynamixel((id, code): (u8, u8), parameters: &[u8], bytes: &mut Vec<u8>) -> Result<(), TooLong> {
    bytes.extend([0xFF, 0xFF, 0xFD, 0x00, id, 0, 0]);
    for &byte in [code].iter().chain(parameters) {
        bytes.push(byte);
        // From the instruction on, a header must not appear.
        if bytes.len() >= 10 && bytes.ends_with(&[0xFF, 0xFF, 0xFD]) {
            bytes.push(0xFD);
        }
    }
    let length = bytes.len() - 7 + 2;
    if length > LONGEST {
        bytes.clear();
        return Err(TooLong {
            actual: length,
            limit: LONGEST,
        });
    }
    bytes[5..7].copy_from_slice(&(length as u16).to_le_bytes());
    let crc = check::crc(bytes);
    bytes.extend(crc.to_le_bytes());
    Ok(())
}

fn feetech((id, code): (u8, u8), parameters: &[u8], bytes: &mut Vec<u8>) -> Result<(), TooLong> {
    let actual = parameters.len() + 2;
    let length = u8::try_from(actual).map_err(|_| TooLong {
        actual,
        limit: u8::MAX.into(),
    })?;
    bytes.extend([0xFF, 0xFF, id, length, code]);
    bytes.extend(parameters);
    bytes.push(check::sum(&bytes[2..]));
    Ok(())
}
