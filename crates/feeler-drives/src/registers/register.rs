//! A value in a control table, and its encoding.

/// A value in a servo's control table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Register {
    /// Name in the manufacturer's table.
    pub name: &'static str,
    /// Address of the first byte.
    pub address: u16,
    /// Number of bytes: 1, 2 or 4.
    pub length: usize,
    /// Representation of negative values.
    pub sign: Sign,
    /// Order of the bytes.
    pub order: ByteOrder,
}

/// Order of the bytes of a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ByteOrder {
    /// Least significant byte first.
    Little,
    /// Most significant byte first (Feetech SCS).
    Big,
}

/// Representation of negative values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sign {
    /// Values are never negative.
    Unsigned,
    /// Two's complement.
    Two,
    /// Sign and magnitude: this bit is the sign, the bits below it are the magnitude (Feetech).
    Bit(u8),
}

impl Register {
    /// Decodes the value in `bytes`.
    pub fn decode(self, bytes: &[u8]) -> i64 {
        let add = |value: i64, &byte: &u8| (value << 8) | i64::from(byte);
        let bytes = bytes.iter().take(self.length);
        let raw = match self.order {
            ByteOrder::Little => bytes.rev().fold(0, add),
            ByteOrder::Big => bytes.fold(0, add),
        };
        match self.sign {
            Sign::Unsigned => raw,
            Sign::Two => {
                let unused = 64 - 8 * self.length as u32;
                (raw << unused) >> unused
            }
            Sign::Bit(bit) if raw & (1 << bit) != 0 => -(raw & !(-1 << bit)),
            Sign::Bit(bit) => raw & !(-1 << bit),
        }
    }

    /// Decodes the value in the `bytes` of a part of the control table that begins at the address `begin`; 0 if the part
    /// does not contain the register.
    pub fn in_part(self, begin: u16, bytes: &[u8]) -> i64 {
        let offset = self.address.checked_sub(begin).map(usize::from);
        self.decode(offset.and_then(|at| bytes.get(at..)).unwrap_or_default())
    }

    /// Appends the encoded `value` to `bytes`; excess bits are truncated.
    pub fn encode(self, value: i64, bytes: &mut Vec<u8>) {
        let raw = match self.sign {
            Sign::Bit(bit) if value < 0 => -value | (1 << bit),
            _ => value,
        };
        match self.order {
            ByteOrder::Little => bytes.extend_from_slice(&raw.to_le_bytes()[..self.length]),
            ByteOrder::Big => bytes.extend_from_slice(&raw.to_be_bytes()[8 - self.length..]),
        }
    }
}
