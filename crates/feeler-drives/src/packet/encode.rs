//! Packet encoder.

use super::{Protocol, check};

/// Maximum length of a Dynamixel packet after its length field; more than any servo of a hand sends.
pub const LONGEST: usize = 1024;

/// Error if a packet is longer than its protocol or a servo's buffer allows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a packet with length {actual}: expected at most {limit} bytes")]
pub struct TooLong {
    /// Number of bytes after the length field.
    pub actual: usize,
    /// Maximum number of bytes.
    pub limit: usize,
}

/// Encodes a packet into `bytes`, replacing its content. `code` is the instruction. For a servo's response, it is
/// [`STATUS`](super::instruction::STATUS), with the error byte as the first parameter, or in Feetech's protocol the
/// status. Does not allocate if `bytes` has sufficient capacity.
///
/// # Errors
/// If there are too many parameters.
pub fn encode(
    protocol: Protocol,
    (id, code): (u8, u8),
    parameters: &[u8],
    bytes: &mut Vec<u8>,
) -> Result<(), TooLong> {
    bytes.clear();
    match protocol {
        Protocol::Dynamixel => dynamixel((id, code), parameters, bytes),
        Protocol::Feetech | Protocol::FeetechScs => feetech((id, code), parameters, bytes),
    }
}

fn dynamixel((id, code): (u8, u8), parameters: &[u8], bytes: &mut Vec<u8>) -> Result<(), TooLong> {
    bytes.extend([0xFF, 0xFF, 0xFD, 0x00, id, 0, 0]);
    for &byte in [code].iter().chain(parameters) {
        bytes.push(byte);
        // After the length field, a header must not occur.
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
