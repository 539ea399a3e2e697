//! A device's stamps on the host's clock, and its frame counter as sequence numbers. No device is needed for it.

/// Arrivals by which the offset between both clocks is known reach back one to two of these, s. Clocks drift by some 50 ppm, a
/// quarter of a millisecond in that time.
const WINDOW: f64 = 5.0;
/// Part of the device's own interval by which a stamp follows the one before it at least.
const LEAST_STEP: f64 = 0.5;

/// Maps a device's clock onto the host's.
///
/// A picture arrives some time after it was taken, never before, so that the clocks' offset is the least difference between arrival
/// and device time: that of the fastest of the last pictures. A stamp never goes back and is never later than the arrival. A device
/// clock that stands still, goes back or runs fast therefore makes no picture look newer than one without a clock would be; one
/// that runs slow makes pictures look older than they are.
#[derive(Debug, Default)]
pub(super) struct DeviceClock {
    anchor: Option<Anchor>,
    /// The newest stamp, s.
    stamp: f64,
}

#[derive(Debug)]
struct Anchor {
    /// Device time of the picture that the others count from, and of the newest, ns.
    origin: u64,
    newest: u64,
    /// Least offset in this window and in the one before, s.
    offset: f64,
    before: f64,
    /// When this window began, s.
    began: f64,
}

impl DeviceClock {
    /// The stamp (s on the host's clock) of a picture that the device took at `device` ns of its own clock and that came in at
    /// `arrival`, s.
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
                (time, LEAST_STEP * step)
            }
            // The first picture, or a clock that was set back or stands still.
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
        // An offset that falls at once would put a picture before the last one, or so close to it that its forces seem to jump.
        let forward = time.max(self.stamp + step).min(arrival);
        self.stamp = forward.max(self.stamp);
        self.stamp
    }
}

fn seconds(nanoseconds: u64) -> f64 {
    nanoseconds as f64 * 1e-9
}

/// Makes sequence numbers of a device's frame numbers, which GigE Vision counts from 1 to 65535 and again from 1.
#[derive(Debug, Default)]
pub(super) struct FrameCounter {
    /// Frame number and sequence number of the newest picture.
    newest: Option<(u64, u64)>,
}

impl FrameCounter {
    /// The sequence number of the picture with the device's number `id`: greater than the last, by as much more than 1 as there
    /// were pictures in between. None of a picture that was taken before the last one.
    pub(super) fn sequence(&mut self, id: u64) -> Option<u64> {
        let sequence = match self.newest {
            None => 0,
            Some((before, sequence)) => sequence.saturating_add(steps(before, id)?),
        };
        self.newest = Some((id, sequence));
        Some(sequence)
    }
}

/// Pictures from number `before` to number `id`; none where that is a late one.
fn steps(before: u64, id: u64) -> Option<u64> {
    const WRAP: u64 = u16::MAX as u64;
    /// A picture is this far behind others at most; a counter that is set back is further.
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
    // Less than half the way around: the counter has wrapped. More: it was set back, or stands still.
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

    /// Device times (ns) and arrivals (s) of 60 pictures a second, by a clock that is `fast` by a part, each late by what `late` says.
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

    /// A network that is fast once in a second: 2 ms, and up to 42 ms else.
    fn late(index: usize) -> f64 {
        if index % 60 == 30 {
            return 2e-3;
        }
        2e-3 + 0.04 * (index as f64 * 12.9898).sin().abs()
    }

    #[test]
    fn stamps_are_exposures_and_the_fastest_way_whatever_the_network_does() {
        for fast in [-50e-6, 0.0, 50e-6] {
            let mut clock = DeviceClock::default();
            let pictures = pictures(60 * 120, fast, late);
            let mut worst = 0.0_f64;
            for (index, &(device, arrival, taken)) in pictures.iter().enumerate() {
                let stamp = clock.stamp(device, arrival);
                // From the first fast picture on. Half a millisecond is what 50 ppm make in two windows; another bound holds
                // until the stamps, which go on, have come back to the offset.
                if index > 120 {
                    worst = worst.max((stamp - taken - 2e-3).abs());
                }
            }
            assert!(worst < 5.5e-4, "{worst} s with a clock {fast} fast");
        }
    }

    #[test]
    fn a_clock_that_is_reset_or_leaps_makes_no_picture_newer_than_it_is() {
        let mut clock = DeviceClock::default();
        // Steady, back to zero, an hour ahead, and standing still.
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
            // All came in at once: none is late by more than the rounding of its millisecond.
            assert!(arrival - stamp < 2e-3, "{stamp} of {arrival}");
            before = stamp;
        }
    }

    proptest! {
        #[test]
        fn whatever_a_device_says_stamps_go_forward_and_not_beyond_arrivals(
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
        // A counter of 64 bits does not wrap there.
        let mut wide = FrameCounter::default();
        let sequences = [65_535, 65_536, 1 << 40].map(|id| wide.sequence(id));
        assert_eq!(sequences, [0, 1, 1 + u64::from(u32::MAX)].map(Some));
    }

    #[test]
    fn a_picture_that_comes_after_a_later_one_has_no_number() {
        let mut counter = FrameCounter::default();
        let ids = [100, 102, 101, 103, 65_535, 2, 65_534, 3];
        let sequences = ids.map(|id| counter.sequence(id));
        let expected = [0, 2, 3, 65_435, 65_437, 65_438];
        assert_eq!(sequences[2], None);
        assert_eq!(sequences[6], None);
        assert!(sequences.into_iter().flatten().eq(expected));
    }
}
