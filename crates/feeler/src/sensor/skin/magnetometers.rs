//! Boards with MLX90393 magnetometers: AnySkin, ReSkin, eFlesh.

use super::step::Step;
use glam::DVec3;
use std::ops::RangeInclusive;

/// Last bytes of a frame.
const END: [u8; 2] = *b"\r\n";
/// Number of bytes per chip: temperature and magnetic flux density along x, y, z as `f32`.
const CHIP: usize = 16;
/// Maximum number of chips of a board.
pub const MOST: usize = 64;
/// Plausible temperatures of a working chip, °C; its specified range is -20 to 85 °C.
const TEMPERATURES: RangeInclusive<f32> = -60.0..=150.0;
/// Maximum flux density, µT: 32768 steps of 9.68 µT, the coarsest resolution of the chip, rounded up.
const LARGEST: f32 = 400_000.0;
/// Minimum flux density other than 0, µT: a hundredth of the finest resolution of the chip.
const SMALLEST: f32 = 0.001;
/// Temperature of emulated chips, °C.
const ROOM: f32 = 25.0;

/// Number of bytes in a frame, including its last two.
pub fn frame_bytes(chips: usize) -> usize {
    CHIP * chips + END.len()
}

/// Appends a frame with the `values` of all chips.
pub fn encode(values: &[DVec3], bytes: &mut Vec<u8>) {
    let limit = f64::from(LARGEST);
    for value in values {
        let flux = value.clamp(DVec3::splat(-limit), DVec3::splat(limit));
        for number in [ROOM, flux.x as f32, flux.y as f32, flux.z as f32] {
            bytes.extend(number.to_le_bytes());
        }
    }
    bytes.extend(END);
}

/// Finds frames by the last bytes of the previous frame and their own, and by the plausibility of their numbers.
#[derive(Debug, Clone)]
pub struct Format {
    chips: usize,
    /// `true` if the next byte is the first of a connection. It may be the first of a frame.
    is_new: bool,
}

impl Format {
    pub fn new(chips: usize) -> Self {
        Self {
            chips,
            is_new: true,
        }
    }

    pub fn restart(&mut self) {
        self.is_new = true;
    }

    /// Decodes a frame at the beginning of `bytes`. Its last bytes are not removed, because they precede the next
    /// frame.
    pub fn step(&mut self, bytes: &[u8], values: &mut [DVec3]) -> Step {
        let first = match self.is_new {
            true => 0,
            false => END.len(),
        };
        if !self.is_new && !bytes.starts_with(&END) {
            return skip_to_end(bytes);
        }
        let end = first + CHIP * self.chips;
        let Some(whole) = bytes.get(..end + END.len()) else {
            return Step::Wait;
        };
        self.is_new = false;
        let (numbers, tail) = whole[first..].split_at(CHIP * self.chips);
        match tail == END && read(numbers, values) {
            true => Step::Frame { first, end },
            false => Step::Skip(1),
        }
    }
}

/// Skips to the next byte that may be the first of a frame's last bytes.
fn skip_to_end(bytes: &[u8]) -> Step {
    match bytes {
        [] | [b'\r'] => Step::Wait,
        [_, rest @ ..] => {
            let next = rest.iter().position(|&byte| byte == END[0]);
            Step::Skip(1 + next.unwrap_or(rest.len()))
        }
    }
}

/// Reads the flux density of each chip; NaN for a chip that has not measured since the board started. Returns `false`
/// if a number is implausible.
fn read(numbers: &[u8], values: &mut [DVec3]) -> bool {
    for (chip, value) in numbers.chunks_exact(CHIP).zip(values) {
        let number = |index: usize| {
            let bytes = chip[4 * index..].first_chunk().copied();
            f32::from_le_bytes(bytes.unwrap_or_default())
        };
        let flux = [number(1), number(2), number(3)];
        if !TEMPERATURES.contains(&number(0)) || !flux.into_iter().all(is_flux) {
            return false;
        }
        *value = match flux {
            [0.0, 0.0, 0.0] => DVec3::NAN,
            flux => DVec3::from_array(flux.map(f64::from)),
        };
    }
    true
}

fn is_flux(number: f32) -> bool {
    number == 0.0 || (SMALLEST..=LARGEST).contains(&number.abs())
}
