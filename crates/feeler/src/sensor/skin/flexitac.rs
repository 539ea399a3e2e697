//! Matrices of pressure-sensitive resistors: FlexiTac.

use super::step::Step;
use glam::DVec3;

/// First bytes of a frame.
const MARKER: [u8; 2] = [0xAA, 0x55];
/// Maximum number of frames compared to find the beginning of one.
const MOST_FRAMES: usize = 6;

/// Number of bytes in a frame, including its marker.
pub fn frame_bytes(taxels: usize) -> usize {
    MARKER.len() + taxels
}

/// Appends a frame with the `values` of all taxels.
pub fn encode(values: &[DVec3], bytes: &mut Vec<u8>) {
    bytes.extend(MARKER);
    // A conversion from `f64` saturates.
    bytes.extend(values.iter().map(|value| value.z.round() as u8));
}

/// Finds frames by their own marker and that of the next frame.
///
/// Pressures may contain the bytes of the marker, in the same position of each frame while they do not change. A
/// beginning is therefore accepted only if it is the only possible one.
#[derive(Debug, Clone)]
pub struct Format {
    taxels: usize,
    /// `true` if a frame begins at the next byte.
    is_found: bool,
}

impl Format {
    pub fn new(taxels: usize) -> Self {
        Self {
            taxels,
            is_found: false,
        }
    }

    pub fn restart(&mut self) {
        self.is_found = false;
    }

    pub fn step(&mut self, bytes: &[u8], values: &mut [DVec3]) -> Step {
        if !self.is_found {
            return self.find(bytes);
        }
        let length = frame_bytes(self.taxels);
        if bytes.len() < length + MARKER.len() {
            return Step::Wait;
        }
        if !is_marker(bytes, 0) || !is_marker(bytes, length) {
            self.is_found = false;
            return Step::Skip(1);
        }
        for (value, &byte) in values.iter_mut().zip(&bytes[MARKER.len()..]) {
            *value = DVec3::new(0.0, 0.0, byte.into());
        }
        Step::Frame {
            first: 0,
            end: length,
        }
    }

    /// Finds the first byte of a frame.
    ///
    /// A candidate is a marker followed by further markers at intervals of one frame. It is accepted if all other
    /// candidates are a whole number of frames away from it; otherwise more frames are compared. Candidates are
    /// searched for over two frames, because lost bytes may include a marker: a false candidate is then never the only
    /// one.
    fn find(&mut self, bytes: &[u8]) -> Step {
        let length = frame_bytes(self.taxels);
        for frames in 2..=MOST_FRAMES {
            if bytes.len() < (frames + 1) * length + MARKER.len() {
                return Step::Wait;
            }
            let begins = |&at: &usize| (0..frames).all(|n| is_marker(bytes, at + n * length));
            let mut places = (0..2 * length).filter(begins);
            let Some(first) = places.next() else { break };
            if places.all(|at| at % length == first % length) {
                self.is_found = true;
                return Step::Skip(first);
            }
        }
        Step::Skip(length)
    }
}

fn is_marker(bytes: &[u8], at: usize) -> bool {
    bytes
        .get(at..)
        .is_some_and(|rest| rest.starts_with(&MARKER))
}
