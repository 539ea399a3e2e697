use super::*;
use proptest::prelude::*;

const OPENED: f64 = 5000.0;
const INTERVAL: f64 = 0.04;

fn driver(time: f64, sequence: u32) -> Option<DriverStamp> {
    Some(DriverStamp {
        time: Some(OPENED + time),
        sequence,
    })
}

#[test]
fn without_driver_stamps_a_late_frame_leaves_a_gap() {
    let mut clock = FrameClock::new(OPENED, 0.01);
    let arrivals = [0.5, 0.51, 0.5198, 0.5502, 0.5502];
    let stamped = arrivals.map(|arrival| clock.stamp(None, arrival));
    assert_eq!(stamped.clone().map(|s| s.sequence), [0, 1, 2, 5, 6]);
    assert_eq!(stamped.clone().map(|s| s.stamp), arrivals);
    // Warns only once.
    let warnings = stamped.map(|s| s.warning.is_some());
    assert_eq!(warnings, [true, false, false, false, false]);
    let mut stopped = FrameClock::new(OPENED, 0.0);
    let numbers = [0.0, 0.0].map(|arrival| stopped.stamp(None, arrival).sequence);
    assert_eq!(numbers, [0, 1]);
}

#[test]
fn driver_stamps_are_used_however_late_images_arrive() {
    let mut clock = FrameClock::new(OPENED, INTERVAL);
    // The program was busy for 3 s and then reads the contents of two buffers; meanwhile the driver dropped frames.
    let frames = [
        (0.10, 0.13, 0, 0),
        (0.14, 0.17, 1, 1),
        (0.18, 3.00, 2, 2),
        (0.22, 3.001, 3, 3),
        (3.02, 3.05, 73, 73),
        (3.06, 3.09, 74, 74),
    ];
    for (taken, arrival, counted, expected) in frames {
        let stamped = clock.stamp(driver(taken, counted), arrival);
        assert_eq!(stamped.warning, None);
        assert_eq!(stamped.sequence, expected);
        assert!((stamped.stamp - taken).abs() < 1e-9, "{stamped:?}");
    }
}

#[test]
fn numbers_wrap_at_the_end_of_32_bits() {
    let mut clock = FrameClock::new(OPENED, INTERVAL);
    let counted = [u32::MAX - 1, u32::MAX, 0, 2];
    let numbers = counted.map(|counted| {
        let arrival = 1.0 + INTERVAL * f64::from(counted.wrapping_add(2));
        clock.stamp(driver(arrival, counted), arrival).sequence
    });
    assert_eq!(numbers, [0, 1, 2, 4]);
}

/// Stamps a frame after nine valid ones, the last of them frame 8.
fn after_good_ones(stamp: Option<DriverStamp>) -> Stamped {
    let mut clock = FrameClock::new(OPENED, INTERVAL);
    for frame in 0..9_u32 {
        let taken = INTERVAL * f64::from(frame);
        let good = clock.stamp(driver(taken, frame), taken + 0.02);
        assert_eq!((good.warning, good.stamp), (None, OPENED + taken - OPENED));
    }
    clock.stamp(stamp, 9.0 * INTERVAL + 0.02)
}

#[test]
fn impossible_stamps_and_numbers_are_replaced_by_arrivals() {
    let arrival = 9.0 * INTERVAL + 0.02;
    let no_time = Some(DriverStamp {
        time: None,
        sequence: 9,
    });
    let cases = [
        (None, "returns no stamps"),
        (no_time, "not of the monotonic clock"),
        (driver(arrival + 0.1, 9), "0.100 s in the future"),
        (driver(f64::MAX, 9), "in the future"),
        (driver(8.0 * INTERVAL, 9), "not later than the last"),
        (driver(-1.5, 9), "older than the image can be"),
        (driver(arrival, 8), "counts frame 8 after frame 8"),
        (driver(arrival, 3), "counts frame 3 after frame 8"),
        (driver(arrival, 1 << 20), "counts frame 1048576 after"),
    ];
    for (stamp, words) in cases {
        let stamped = after_good_ones(stamp);
        let warning = stamped.warning.expect("a warning");
        assert!(warning.contains(words), "{warning}");
        assert_eq!((stamped.stamp, stamped.sequence), (arrival, 9), "{words}");
    }
    // Clock conversion may be off by a few milliseconds.
    let early = after_good_ones(driver(arrival + 0.004, 9));
    assert_eq!((early.stamp, early.warning), (arrival, None));
}

proptest! {
    #[test]
    fn stamps_never_decrease_or_exceed_arrivals(
        opened in prop_oneof![Just(OPENED), any::<f64>()],
        interval in prop_oneof![Just(INTERVAL), any::<f64>()],
        said in prop::collection::vec(
            (
                prop_oneof![Just(None), any::<f64>().prop_map(Some), (0.0..10.0_f64).prop_map(|t| Some(OPENED + t))],
                any::<u32>(),
                0.0..1.0_f64,
            ),
            1..100,
        ),
    ) {
        let mut clock = FrameClock::new(opened, interval);
        let (mut arrival, mut before) = (0.0, None::<Stamped>);
        for (time, sequence, later) in said {
            arrival += later;
            let stamped = clock.stamp(Some(DriverStamp { time, sequence }), arrival);
            prop_assert!(stamped.stamp <= arrival && stamped.stamp.is_finite(), "{:?}", stamped);
            if let Some(before) = before {
                prop_assert!(stamped.stamp >= before.stamp && stamped.sequence > before.sequence);
            }
            before = Some(stamped);
        }
    }
}
