//! PaXini modules of the third generation.
//!
//! ```text
//! request   55 AA  09 00        device 00  FB  0E 04 00 00  count 00       sum
//! response  AA 55  (10 + count) device 00  FB  0E 04 00 00  count  status  data  sum
//! ```
//!
//! Numbers are little-endian. `count` is the number of data bytes, 3 per taxel. The sum of all bytes of a packet is 0
//! modulo 256. Readings are in tenths of a newton.

use super::step::Step;
use glam::DVec3;

/// First bytes of a request.
const REQUEST: [u8; 2] = [0x55, 0xAA];
/// First bytes of a response.
const RESPONSE: [u8; 2] = [0xAA, 0x55];
/// Code of the function that reads registers.
const READ: u8 = 0xFB;
/// Index of the function code in a packet.
const FUNCTION: usize = 6;
/// Address of the register with the forces on all taxels.
const FORCES: [u8; 4] = [0x0E, 0x04, 0x00, 0x00];
/// Number of bytes per taxel: x and y as `i8`, z as `u8`.
const TAXEL: usize = 3;
/// Number of bytes in a response before its data.
const HEADER: usize = 14;

/// Number of bytes in a response.
pub fn response_bytes(taxels: usize) -> usize {
    HEADER + data_bytes(taxels) + 1
}

fn data_bytes(taxels: usize) -> usize {
    TAXEL * taxels
}

/// Checksum: byte that makes the sum of a packet 0 modulo 256.
fn check_byte(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0_u8, |sum, &byte| sum.wrapping_sub(byte))
}

/// First 13 bytes of a packet, up to the check byte of a request or the status of a response.
fn start(marker: [u8; 2], length: usize, address: u8, taxels: usize) -> [u8; HEADER - 1] {
    let [low, high] = (length as u16).to_le_bytes();
    let [count_low, count_high] = (data_bytes(taxels) as u16).to_le_bytes();
    let [a, b, c, d] = FORCES;
    let [m, n] = marker;
    [
        m, n, low, high, address, 0, READ, a, b, c, d, count_low, count_high,
    ]
}

/// Request for the forces on all taxels of the module with this `address`.
pub fn request(address: u8, taxels: usize) -> Vec<u8> {
    let mut bytes = start(REQUEST, 9, address, taxels).to_vec();
    bytes.push(check_byte(&bytes));
    bytes
}

/// Number of taxels in a request; `None` if it is too short.
pub fn requested(request: &[u8]) -> Option<usize> {
    let &[low, high] = request.get(HEADER - 3..HEADER - 1)?.first_chunk()?;
    Some(usize::from(u16::from_le_bytes([low, high])) / TAXEL)
}

/// First bytes of the response of the module with this `address`.
fn response_start(address: u8, taxels: usize) -> [u8; HEADER - 1] {
    start(RESPONSE, 10 + data_bytes(taxels), address, taxels)
}

/// Appends the response with `values` in tenths of a newton.
pub fn encode(address: u8, values: &[DVec3], bytes: &mut Vec<u8>) {
    let begin = bytes.len();
    bytes.extend(response_start(address, values.len()));
    bytes.push(0);
    for value in values {
        // Conversions from `f64` saturate.
        let value = value.round();
        bytes.extend([value.x as i8 as u8, value.y as i8 as u8, value.z as u8]);
    }
    bytes.push(check_byte(&bytes[begin..]));
}

/// Finds responses by their header and checksum.
#[derive(Debug, Clone)]
pub struct Format {
    start: [u8; HEADER - 1],
    taxels: usize,
}

impl Format {
    pub fn new(address: u8, taxels: usize) -> Self {
        Self {
            start: response_start(address, taxels),
            taxels,
        }
    }

    /// Decodes a response at the beginning of `bytes`. If its status is not 0, the module reports an error and there
    /// are no values.
    pub fn step(&self, bytes: &[u8], values: &mut [DVec3]) -> Step {
        let length = response_bytes(self.taxels);
        // The source does not document the function code of responses.
        let alike = |(index, (a, b)): (usize, (&u8, &u8))| a == b || index == FUNCTION;
        let header = bytes.iter().zip(&self.start).enumerate();
        if !header.clone().all(alike) {
            return Step::Skip(1);
        }
        let Some(packet) = bytes.get(..length) else {
            return Step::Wait;
        };
        if check_byte(packet) != 0 {
            return Step::Skip(1);
        }
        let is_good = packet[HEADER - 1] == 0;
        let taxels = packet[HEADER..].chunks_exact(TAXEL);
        for (value, taxel) in values.iter_mut().zip(taxels) {
            *value = match taxel {
                &[x, y, z] if is_good => DVec3::new((x as i8).into(), (y as i8).into(), z.into()),
                _ => DVec3::NAN,
            };
        }
        Step::Frame {
            first: 0,
            end: length,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Packets of a real module, a request and a response without data, recorded between it and PaXini's program.
    #[test]
    fn sums_agree_with_recorded_packets() {
        for packet in [
            &[0x55, 0xAA, 9, 0, 3, 0, 0xFB, 0xF0, 3, 0, 0, 0x7B, 0, 0x8C][..],
            &[0xAA, 0x55, 10, 0, 3, 0, 0x79, 3, 0, 0, 0, 1, 0, 0, 0x77][..],
        ] {
            let (check, content) = packet.split_last().unwrap();
            assert_eq!(check_byte(content), *check);
            assert_eq!(check_byte(packet), 0);
        }
    }

    #[test]
    fn requests_are_recognized() {
        assert_eq!(requested(&request(7, 31)), Some(31));
        assert_eq!(requested(&[0x55]), None);
    }

    /// The request of the published driver for module 0 with 31 taxels.
    #[test]
    fn requests_are_those_of_the_published_driver() {
        let expected = [0x55, 0xAA, 9, 0, 1, 0, 0xFB, 0x0E, 4, 0, 0, 93, 0];
        let sum: u32 = expected.iter().map(|&byte| u32::from(byte)).sum();
        let request = request(1, 31);
        assert_eq!(request[..13], expected);
        assert_eq!((sum + u32::from(request[13])) % 256, 0);
    }
}
