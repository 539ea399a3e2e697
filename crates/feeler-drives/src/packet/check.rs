//! Checksums of packets.

/// CRC-16/BUYPASS of `bytes` (polynomial 0x8005, not reflected, initial value 0), sent low byte first by Dynamixel 2.0.
pub fn crc(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0, |crc: u16, &byte| {
        let index = (crc >> 8) as u8 ^ byte;
        (crc << 8) ^ TABLE[index as usize]
    })
}

/// Checksum of a Feetech packet, over the `bytes` between header and checksum.
pub fn sum(bytes: &[u8]) -> u8 {
    !bytes.iter().fold(0u8, |sum, &byte| sum.wrapping_add(byte))
}

const TABLE: [u16; 256] = table();

const fn table() -> [u16; 256] {
    let mut table = [0; 256];
    let mut index = 0;
    while index < 256 {
        let mut value = (index as u16) << 8;
        let mut bit = 0;
        while bit < 8 {
            let carry = value & 0x8000 != 0;
            value <<= 1;
            if carry {
                value ^= 0x8005;
            }
            bit += 1;
        }
        table[index] = value;
        index += 1;
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The check value of CRC-16/BUYPASS in the catalogue of parametrised CRC algorithms.
    #[test]
    fn crc_is_buypass() {
        assert_eq!(crc(b"123456789"), 0xFEE8);
    }

    /// The first and last entries of the table in the vendor's CRC example (e-Manual, "CRC Calculation").
    #[test]
    fn table_equals_the_vendors() {
        assert_eq!(TABLE[..4], [0x0000, 0x8005, 0x800F, 0x000A]);
        assert_eq!(TABLE[252..], [0x0208, 0x820D, 0x8207, 0x0202]);
    }
}
