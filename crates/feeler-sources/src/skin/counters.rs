//! Counters of a connection, which other threads may read.

use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};

/// Counters of a [`SkinSensor`](super::SkinSensor), displayed in one line.
#[derive(Debug, Default)]
pub struct SkinCounters {
    /// Number of decoded frames.
    frames: AtomicU64,
    /// Number of bytes outside of frames.
    skipped: AtomicU64,
    /// Number of times that bytes were lost, inserted or changed.
    losses: AtomicU64,
    /// Number of times that the port was opened again.
    reconnections: AtomicU64,
    /// Number of readings without forces, because no frame arrived in time.
    missing: AtomicU64,
    /// Stamp of the first frame, s, as bits of `f64`.
    first: AtomicU64,
    /// Stamp of the latest frame, s, as bits of `f64`.
    latest: AtomicU64,
}

impl SkinCounters {
    /// Counts a frame with this stamp (s).
    pub(super) fn frame(&self, stamp: f64) {
        if self.frames.fetch_add(1, Ordering::Relaxed) == 0 {
            self.first.store(stamp.to_bits(), Ordering::Relaxed);
        }
        self.latest.store(stamp.to_bits(), Ordering::Relaxed);
    }

    /// Stores the numbers of skipped bytes and of losses.
    pub(super) fn damage(&self, skipped: u64, losses: u64) {
        self.skipped.store(skipped, Ordering::Relaxed);
        self.losses.store(losses, Ordering::Relaxed);
    }

    pub(super) fn reconnection(&self) {
        self.reconnections.fetch_add(1, Ordering::Relaxed);
    }

    pub(super) fn missing(&self) {
        self.missing.fetch_add(1, Ordering::Relaxed);
    }

    /// Number of decoded frames.
    pub fn frames(&self) -> u64 {
        self.frames.load(Ordering::Relaxed)
    }

    /// Number of bytes that were not part of a frame.
    pub fn skipped_bytes(&self) -> u64 {
        self.skipped.load(Ordering::Relaxed)
    }

    /// Number of times that bytes were lost, inserted or changed.
    pub fn losses(&self) -> u64 {
        self.losses.load(Ordering::Relaxed)
    }

    /// Number of times that the port was opened again.
    pub fn reconnections(&self) -> u64 {
        self.reconnections.load(Ordering::Relaxed)
    }

    /// Number of readings without forces, because no frame arrived in time.
    pub fn missing_readings(&self) -> u64 {
        self.missing.load(Ordering::Relaxed)
    }

    /// Mean number of frames per second (Hz), or `None` before the second frame.
    pub fn rate(&self) -> Option<f64> {
        let stamp = |bits: &AtomicU64| f64::from_bits(bits.load(Ordering::Relaxed));
        let span = stamp(&self.latest) - stamp(&self.first);
        let intervals = self.frames().saturating_sub(1) as f64;
        (span > 0.0).then_some(intervals / span)
    }
}

impl fmt::Display for SkinCounters {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rate = self.rate().unwrap_or(0.0);
        let (frames, skipped, losses) = (self.frames(), self.skipped_bytes(), self.losses());
        let (missing, reconnections) = (self.missing_readings(), self.reconnections());
        write!(
            f,
            "{frames} frames at {rate:.1} Hz; {skipped} bytes skipped, {losses} losses, {missing} readings missing, {reconnections} reconnections"
        )
    }
}
