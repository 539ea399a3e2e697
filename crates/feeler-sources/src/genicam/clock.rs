//! Maps a camera's stamps onto the host's clock and its frame counter onto sequence numbers. Independent of hardware.

/// Duration of a window, s. The offset of the clocks is estimated from arrivals in the last one to two windows. Clocks
/// drift by some 50 ppm, a quarter of a millisecond in that time.
const WINDOW: f64 = 5.0;
/// Minimum increment of a stamp, as a fraction of the device's own interval.
const MIN_STEP: f64 = 0.5;

/// Maps a device's clock onto the host's.
///
/// An image arrives some time after its exposure, never before. The offset of the clocks is therefore the smallest
/// difference between arrival and device time among recent images. A stamp never decreases and is never later than
/// the arrival. If the device's clock stops, goes back or runs fast, no image looks newer than it would without a
/// device clock; if it runs slow, images look older than they are.
#[derive(Debug, Default)]
pub(super) struct DeviceClock {
    anchor: Option<Anchor>,
    /// Latest stamp, s.
    stamp: f64,
}

#[derive(Debug)]
struct Anchor {
    /// Device time of the reference image, ns.
    origin: u64,
    /// Device time of the latest image, ns.
    newest: u64,
    /// Smallest offset in the current window, s.
    offset: f64,
    /// Smallest offset in the previous window, s.
    before: f64,
    /// Start of this window, s.
    began: f64,
}

impl DeviceClock {
    /// Returns the stamp (s, host clock) of an image with the device time `device` (ns) that arrived at `arrival`
    /// (s).
    pub(super) fn stamp(&mut self, device: u64, arrival: f64) -> f64 {
        let known = self.anchor.as_mut().filter(|known| device > known.newest);
        let (time, step) = match known {
            Some(known) => {
                let step = seconds(device - known.newest);
                known.newest = device;
                let offset = arrival - seconds(device - known.origin);
                if arrival - known.began >= WINDOW {
                    (known.before, known.offset, known.began) = (known.offset, offset, arrival);
                } else {
                    known.offset = known.offset.min(offset);
                }
                let time = seconds(device - known.origin) + known.offset.min(known.before);
                (time, MIN_STEP * step)
            }
            // First image, or a clock that was set back or has stopped.
            None => {
                self.anchor = Some(Anchor {
                    origin: device,
                    newest: device,
                    offset: arrival,
                    before: f64::INFINITY,
                    began: arrival,
                });
                (arrival, 0.0)
            }
        };
        // A sudden drop of the offset would put an image before the previous one, or so close to it that its forces
        // seem to jump.
        let forward = time.max(self.stamp + step).min(arrival);
        self.stamp = forward.max(self.stamp);
        self.stamp
    }
}

fn seconds(nanoseconds: u64) -> f64 {
    nanoseconds as f64 * 1e-9
}

/// Converts a device's frame numbers to sequence numbers. GigE Vision counts from 1 to 65535 and restarts at 1.
#[derive(Debug, Default)]
pub(super) struct FrameCounter {
    /// Frame number and sequence number of the latest image.
    newest: Option<(u64, u64)>,
}

impl FrameCounter {
    /// Returns the sequence number of the image with the device's frame number `id`. It exceeds the previous one by 1
    /// plus the number of missing images. `None` if the image was taken before the previous one.
    pub(super) fn sequence(&mut self, id: u64) -> Option<u64> {
        let sequence = match self.newest {
            None => 0,
            Some((before, sequence)) => sequence.saturating_add(steps(before, id)?),
        };
        self.newest = Some((id, sequence));
        Some(sequence)
    }
}

/// Number of images from frame `before` to frame `id`, or `None` if `id` is a late arrival.
fn steps(before: u64, id: u64) -> Option<u64> {
    const WRAP: u64 = u16::MAX as u64;
    /// Maximum lag of a late image, in frames. A larger step back means that the counter was reset.
    const LATE: u64 = 64;
    let behind = match id > before {
        true if id <= WRAP => (before + WRAP).saturating_sub(id),
        true => u64::MAX,
        false => before - id,
    };
    if (1..=LATE).contains(&behind) {
        return None;
    }
    if id > before {
        return Some((id - before).min(u64::from(u32::MAX)));
    }
    // Less than half a turn: the counter has wrapped. More: it was reset or has stopped.
    let around = (WRAP + id).saturating_sub(before);
    if before <= WRAP && around < WRAP / 2 {
        return Some(around.max(1));
    }
    Some(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Device times (ns), arrivals (s) and exposure times (s) of images at 60 Hz. The device clock is fast by the
    /// fraction `fast`; `late` returns the latency (s) of each image.
    fn pictures(count: usize, fast: f64, late: impl Fn(usize) -> f64) -> Vec<(u64, f64, f64)> {
        let mut arrived = 0.0_f64;
        let picture = |index: usize| {
            let taken = 100.0 + index as f64 / 60.0;
            arrived = arrived.max(taken + late(index));
            let device = 7_000_000_000_000 + (taken * (1.0 + fast) * 1e9) as u64;
            (device, arrived, taken)
        };
        (0..count).map(picture).collect()
    }

    /// Latency of a network that is fast once a second: 2 ms then, up to 42 ms otherwise.
    fn late(index: usize) -> f64 {
        if index % 60 == 30 {
            return 2e-3;
        }
        2e-3 + 0.04 * (index as f64 * 12.9898).sin().abs()
    }

    #[test]
    fn stamps_are_exposure_times_plus_the_smallest_latency() {
        for fast in [-50e-6, 0.0, 50e-6] {
            let mut clock = DeviceClock::default();
            let pictures = pictures(60 * 120, fast, late);
            let mut worst = 0.0_f64;
            for (index, &(device, arrival, taken)) in pictures.iter().enumerate() {
                let stamp = clock.stamp(device, arrival);
                // Checked from the first fast image on. 50 ppm amount to half a millisecond in two windows. The bound
                // is wider because stamps advance steadily until they reach the new offset.
                if index > 120 {
                    worst = worst.max((stamp - taken - 2e-3).abs());
                }
            }
            assert!(worst < 5.5e-4, "{worst} s with a clock {fast} fast");
        }
    }

    #[test]
    fn a_clock_that_is_reset_or_jumps_makes_no_image_newer_than_its_arrival() {
        let mut clock = DeviceClock::default();
        // A steady clock, one reset to zero, one an hour ahead, and one that has stopped.
        let devices = [
            [10_000, 10_016, 10_033],
            [1, 17, 34],
            [3_600_000, 3_600_016, 3_600_033],
            [3_600_033; 3],
        ];
        let mut arrival = 50.0;
        let mut before = 0.0;
        for device in devices.into_iter().flatten() {
            arrival += 1.0 / 60.0;
            let stamp = clock.stamp(device * 1_000_000, arrival);
            assert!(stamp > before && stamp <= arrival, "{stamp} of {arrival}");
            // All images arrived without latency, so the error is only the rounding to a millisecond.
            assert!(arrival - stamp < 2e-3, "{stamp} of {arrival}");
            before = stamp;
        }
    }

    proptest! {
        #[test]
        fn stamps_never_decrease_or_exceed_arrivals(
            said in proptest::collection::vec((any::<u64>(), 0.0..1.0_f64), 1..200)
        ) {
            let mut clock = DeviceClock::default();
            let (mut arrival, mut before) = (0.0, 0.0);
            for (device, later) in said {
                arrival += later;
                let stamp = clock.stamp(device, arrival);
                prop_assert!(stamp >= before && stamp <= arrival, "{} of {}", stamp, arrival);
                before = stamp;
            }
        }

        #[test]
        fn sequence_numbers_grow(ids in proptest::collection::vec(any::<u64>(), 1..200)) {
            let mut counter = FrameCounter::default();
            let sequences: Vec<u64> = ids.into_iter().filter_map(|id| counter.sequence(id)).collect();
            prop_assert_eq!(sequences.first(), Some(&0));
            prop_assert!(sequences.windows(2).all(|pair| pair[1] > pair[0]));
        }
    }

    #[test]
    fn missing_pictures_are_counted_across_the_end_of_sixteen_bits() {
        let mut counter = FrameCounter::default();
        let ids = [65_530, 65_531, 65_533, 65_535, 1, 3, 3, 20_000, 7];
        let sequences = ids.map(|id| counter.sequence(id).expect("a newer one"));
        assert_eq!(sequences, [0, 1, 3, 5, 6, 8, 9, 20_006, 20_007]);
        // A 64-bit counter does not wrap at 16 bits.
        let mut wide = FrameCounter::default();
        let sequences = [65_535, 65_536, 1 << 40].map(|id| wide.sequence(id));
        assert_eq!(sequences, [0, 1, 1 + u64::from(u32::MAX)].map(Some));
    }

    #[test]
    fn an_image_that_arrives_after_a_later_one_has_no_number() {
        let mut counter = FrameCounter::default();
        let ids = [100, 102, 101, 103, 65_535, 2, 65_534, 3];
        let sequences = ids.map(|id| counter.sequence(id));
        let expected = [0, 2, 3, 65_435, 65_437, 65_438];
        assert_eq!(sequences[2], None);
        assert_eq!(sequences[6], None);
        assert!(sequences.into_iter().flatten().eq(expected));
    }
}
