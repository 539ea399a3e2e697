//! Driver's stamp and sequence number of an image.
//!
//! `linuxvideo` hides them. The driver returns them again for a buffer that is dequeued and not yet requeued
//! (`VIDIOC_QUERYBUF`).

use linuxvideo::stream::ReadStream;
use rustix::fd::{AsFd, OwnedFd};
use rustix::io::Errno;
use rustix::ioctl::{Updater, ioctl, opcode};
use std::ffi::{c_long, c_ulong};

/// `V4L2_BUF_TYPE_VIDEO_CAPTURE`
const VIDEO_CAPTURE: u32 = 1;
/// `V4L2_MEMORY_MMAP`
const MMAP: u32 = 1;
/// `V4L2_BUF_FLAG_QUEUED`, `V4L2_BUF_FLAG_DONE`: the driver owns the buffer.
const OF_THE_DRIVER: u32 = 0x2 | 0x4;
/// `V4L2_BUF_FLAG_TIMESTAMP_MASK`.
const CLOCK: u32 = 0xe000;
/// `V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC`.
const MONOTONIC: u32 = 0x2000;
/// Maximum number of buffers of a stream (`VIDEO_MAX_FRAME`).
const MOST: u32 = 32;

/// `struct v4l2_buffer`
#[repr(C)]
#[derive(Debug, Clone, Copy, Default)]
struct Buffer {
    index: u32,
    kind: u32,
    bytes_used: u32,
    flags: u32,
    field: u32,
    timestamp: [c_long; 2],
    timecode: [u32; 4],
    sequence: u32,
    memory: u32,
    place: c_ulong,
    length: u32,
    reserved: [u32; 2],
}

const QUERYBUF: rustix::ioctl::Opcode = opcode::read_write::<Buffer>(b'V', 9);

/// The driver's stamp and number of an image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct DriverStamp {
    /// Time on the monotonic clock, s; `None` if the driver uses another clock or the time is invalid.
    pub(super) time: Option<f64>,
    /// Number of the image since streaming started.
    pub(super) sequence: u32,
}

/// The buffers of a stream.
pub(super) struct StreamBuffers {
    device: OwnedFd,
}

impl StreamBuffers {
    /// Returns the buffers of `stream`.
    ///
    /// # Errors
    /// If the process has no file descriptor left.
    pub(super) fn of(stream: &ReadStream) -> std::io::Result<Self> {
        let device = stream.as_fd().try_clone_to_owned()?;
        Ok(Self { device })
    }

    /// Stamp of the buffer that is currently dequeued; `None` unless the driver reports exactly one.
    pub(super) fn dequeued(&self) -> Option<DriverStamp> {
        let buffers = (0..MOST).map_while(|index| self.query(index).ok());
        let mut dequeued = buffers.filter(|buffer| buffer.flags & OF_THE_DRIVER == 0);
        let buffer = dequeued.next()?;
        dequeued.next().is_none().then(|| stamp_of(&buffer))
    }

    /// Queries the state of buffer `index`.
    fn query(&self, index: u32) -> Result<Buffer, Errno> {
        let mut buffer = Buffer {
            index,
            kind: VIDEO_CAPTURE,
            memory: MMAP,
            ..Buffer::default()
        };
        // SAFETY: `Buffer` has the layout of `struct v4l2_buffer`, which this ioctl reads and writes; its size is
        // part of the opcode. The memory that `place` refers to belongs to the driver and is not accessed.
        unsafe { ioctl(&self.device, Updater::<QUERYBUF, Buffer>::new(&mut buffer))? };
        Ok(buffer)
    }
}

fn stamp_of(buffer: &Buffer) -> DriverStamp {
    let [seconds, microseconds] = buffer.timestamp;
    let is_time =
        seconds >= 0 && (0..1_000_000).contains(&microseconds) && buffer.timestamp != [0; 2];
    let is_monotonic = buffer.flags & CLOCK == MONOTONIC;
    let time = seconds as f64 + 1e-6 * microseconds as f64;
    DriverStamp {
        time: (is_time && is_monotonic).then_some(time),
        sequence: buffer.sequence,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_buffer_has_the_kernel_s_layout() {
        // `videodev2.h` on 64 bits: 88 bytes, `VIDIOC_QUERYBUF` is 0xc0585609.
        if cfg!(target_pointer_width = "64") {
            assert_eq!(size_of::<Buffer>(), 88);
            assert_eq!(std::mem::offset_of!(Buffer, timestamp), 24);
            assert_eq!(std::mem::offset_of!(Buffer, sequence), 56);
            assert_eq!(std::mem::offset_of!(Buffer, length), 72);
            assert_eq!(QUERYBUF, 0xc058_5609);
        }
    }

    #[test]
    fn other_clocks_and_invalid_times_give_none() {
        let buffer = |timestamp, flags| Buffer {
            timestamp,
            flags,
            sequence: 7,
            ..Buffer::default()
        };
        let good = stamp_of(&buffer([12, 500_000], MONOTONIC | 0x1));
        assert_eq!((good.time, good.sequence), (Some(12.5), 7));
        for (timestamp, flags) in [
            ([12, 500_000], 0),
            ([12, 500_000], 0x4000),
            ([0, 0], MONOTONIC),
            ([-1, 0], MONOTONIC),
            ([12, 1_000_000], MONOTONIC),
            ([12, -1], MONOTONIC),
        ] {
            assert_eq!(stamp_of(&buffer(timestamp, flags)).time, None);
        }
    }
}
