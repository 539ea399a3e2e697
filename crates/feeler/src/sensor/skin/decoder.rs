//! Decodes the bytes of a skin.

use super::step::Step;
use super::{SerialConfig, SkinProtocol};
use super::{flexitac, magnetometers, paxini};
use glam::DVec3;

/// Size of the buffer for one read, bytes; larger reads allocate.
const READ: usize = 4096;
/// Maximum number of frames buffered while searching for the beginning of a frame.
const FRAMES: usize = 8;

#[derive(Debug, Clone)]
enum Format {
    Magnetometers(magnetometers::Format),
    Flexitac(flexitac::Format),
    Paxini(paxini::Format),
}

/// A decoded frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SkinFrame {
    /// Index of the frame's first byte among all bytes of the stream.
    pub first_byte: u64,
}

/// Decodes the bytes of a skin. Never panics; allocates only if more than 4096 bytes arrive at once.
///
/// A frame is returned only if the bytes before or after it confirm its boundaries. Lost or inserted bytes invalidate
/// the frame that contains them, and at most one frame before and one after. Only PaXini's protocol has a checksum (8
/// bits; it misses 1 in 256 damaged packets). In the other protocols, a changed bit is not detected if the value
/// remains plausible. If exactly one frame's length of bytes is lost, the parts of two frames are returned as one.
#[derive(Debug, Clone)]
pub struct SkinDecoder {
    format: Format,
    taxels: usize,
    bytes: Vec<u8>,
    /// Index of the first byte in `bytes` that has not been decoded.
    next: usize,
    /// Number of bytes of the stream that precede `bytes`.
    before: u64,
    frames: u64,
    skipped: u64,
    losses: u64,
    /// `true` if the decoder is synchronized: the latest bytes were part of frames.
    is_in_step: bool,
}

impl SkinDecoder {
    /// Creates a decoder for a skin of `taxels` taxels.
    pub fn new(config: &SerialConfig, taxels: usize) -> Self {
        let format = match config.protocol {
            SkinProtocol::Magnetometers => {
                Format::Magnetometers(magnetometers::Format::new(taxels))
            }
            SkinProtocol::Flexitac => Format::Flexitac(flexitac::Format::new(taxels)),
            SkinProtocol::Paxini => Format::Paxini(paxini::Format::new(config.address, taxels)),
        };
        Self {
            format,
            taxels,
            bytes: Vec::with_capacity(READ + FRAMES * config.frame_bytes(taxels)),
            next: 0,
            before: 0,
            frames: 0,
            skipped: 0,
            losses: 0,
            is_in_step: false,
        }
    }

    /// Number of taxels.
    pub fn taxels(&self) -> usize {
        self.taxels
    }

    /// Number of frames decoded so far.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Number of bytes that were not part of a frame.
    pub fn skipped_bytes(&self) -> u64 {
        self.skipped
    }

    /// Number of losses of synchronization because bytes were lost, inserted or changed.
    pub fn losses(&self) -> u64 {
        self.losses
    }

    /// Number of bytes received so far.
    pub fn stream_bytes(&self) -> u64 {
        self.before + self.bytes.len() as u64
    }

    /// Appends received bytes.
    pub fn feed(&mut self, bytes: &[u8]) {
        self.bytes.drain(..self.next);
        self.before += self.next as u64;
        self.next = 0;
        self.bytes.extend_from_slice(bytes);
    }

    /// Discards all buffered bytes. The next byte is the first of a new connection.
    pub fn restart(&mut self) {
        self.before += self.bytes.len() as u64;
        self.bytes.clear();
        self.next = 0;
        self.is_in_step = false;
        match &mut self.format {
            Format::Magnetometers(format) => format.restart(),
            Format::Flexitac(format) => format.restart(),
            Format::Paxini(_) => {}
        }
    }

    /// Decodes the next frame into `values`, the columns x, y and z of each taxel, NaN if invalid. Returns `None` if
    /// more bytes are required, or if `values` has another number of taxels.
    pub fn next_frame(&mut self, values: &mut [DVec3]) -> Option<SkinFrame> {
        if values.len() != self.taxels {
            return None;
        }
        loop {
            let bytes = &self.bytes[self.next..];
            let step = match &mut self.format {
                Format::Magnetometers(format) => format.step(bytes, values),
                Format::Flexitac(format) => format.step(bytes, values),
                Format::Paxini(format) => format.step(bytes, values),
            };
            match step {
                Step::Wait => return None,
                Step::Skip(count) => {
                    self.skipped += count as u64;
                    self.next += count;
                    self.losses += u64::from(std::mem::take(&mut self.is_in_step));
                }
                Step::Frame { first, end } => {
                    let frame = SkinFrame {
                        first_byte: self.before + (self.next + first) as u64,
                    };
                    self.frames += 1;
                    self.next += end;
                    self.is_in_step = true;
                    return Some(frame);
                }
            }
        }
    }
}
