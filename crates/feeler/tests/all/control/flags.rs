//! Flag analyzer compared with its definitions (paper, Fig. 4; design, section 7) on hand-made frames.

use feeler::control::{FingerFlags, FlagAnalyzer, FlagThresholds};
use feeler::sensor::forces::{NO_FORCE, TactileFrame};
use glam::DVec3;

/// F1 and F2 are sums of powers of two, so a force can equal them exactly.
const THRESHOLDS: FlagThresholds = FlagThresholds {
    touch_force: 0.125,
    over_force: 1.5,
    slip_threshold: 4.0,
};

fn frame(sequence: u64, stamp: f64, forces: &[DVec3]) -> TactileFrame {
    TactileFrame {
        sequence,
        stamp,
        forces: forces.to_vec(),
    }
}

fn analyze(frames: &[(f64, &[DVec3])]) -> FingerFlags {
    let mut analyzer = FlagAnalyzer::new(THRESHOLDS, frames[0].1.len());
    let numbered = (0..).zip(frames);
    let flags = numbered.map(|(n, (stamp, forces))| analyzer.analyze(&frame(n, *stamp, forces)));
    flags.last().expect("a frame")
}

fn compression(force: f64) -> FingerFlags {
    analyze(&[(0.0, &[DVec3::ZERO, DVec3::Z * force])])
}

/// An element without a valid force raises no flag, and has no shear rate before its second valid frame.
#[test]
fn an_element_without_a_valid_force_raises_no_flag() {
    let pressed = [DVec3::new(1.0, 0.0, 2.0), DVec3::Z];
    let unknown = [NO_FORCE, DVec3::Z];
    let mut analyzer = FlagAnalyzer::new(THRESHOLDS, 2);
    let mut flags = |n: u64, forces: &[DVec3]| {
        let flags = analyzer.analyze(&frame(n, 0.01 * n as f64, forces));
        (flags, analyzer.shear_rate().to_vec())
    };
    flags(0, &[DVec3::ZERO, DVec3::Z]);
    let (seen, rates) = flags(1, &unknown);
    assert_eq!(
        (seen.slip, seen.over, seen.largest_element),
        (false, false, Some(1))
    );
    assert_eq!((seen.grasp_force, rates), (1.0, vec![0.0; 2]));
    let (seen, rates) = flags(2, &pressed);
    assert_eq!((seen.slip, seen.over), (false, true));
    assert_eq!(rates, [0.0; 2]);
    let (seen, rates) = flags(3, &[DVec3::new(0.0, 0.0, 2.0), DVec3::Z]);
    assert!(seen.slip && (rates[0] - 100.0).abs() < 1e-9, "{rates:?}");
}

#[test]
fn no_flag_is_raised_without_load() {
    assert_eq!(compression(0.0), FingerFlags::default());
}

#[test]
fn touch_and_over_require_forces_above_their_thresholds() {
    for (force, touch, over) in [
        (0.125, false, false),
        (0.125 + 1e-15, true, false),
        (1.5, true, false),
        (1.5 + 1e-15, true, true),
        (-2.0, false, false),
    ] {
        let flags = compression(force);
        assert_eq!(
            (flags.touch, flags.over, flags.slip),
            (touch, over, false),
            "{force} N"
        );
        assert_eq!(flags.largest_element, touch.then_some(1));
        assert_eq!(flags.grasp_force, force.max(0.0));
    }
}

#[test]
fn slip_is_a_shear_rate_above_its_threshold_and_implies_touch() {
    // A quarter of a second is exactly representable, and so is a 3-4-5 triangle: |(0.6, 0.8)| = 1.
    for (change, slip) in [(1.0, false), (1.0 + 1e-12, true)] {
        let moved = change * DVec3::new(0.6, 0.8, 0.0);
        let flags = analyze(&[(1.0, &[DVec3::ZERO]), (1.25, &[moved])]);
        assert_eq!((flags.slip, flags.touch), (slip, slip), "{change} N");
        assert_eq!(flags.largest_element, None);
    }
    // Neither fast compression nor the first frame is a slip.
    let pressed = analyze(&[(0.0, &[DVec3::ZERO]), (0.01, &[DVec3::Z])]);
    assert!(pressed.touch && !pressed.slip);
    assert!(!analyze(&[(0.0, &[DVec3::X * 9.0])]).slip);
}

#[test]
fn shear_rates_are_per_element_and_use_the_stamps() {
    let mut analyzer = FlagAnalyzer::new(THRESHOLDS, 2);
    analyzer.analyze(&frame(0, 0.0, &[DVec3::ZERO; 2]));
    // After a dropped frame, the sequence skips a number and the stamp contains the time.
    analyzer.analyze(&frame(3, 0.5, &[DVec3::X, DVec3::new(0.0, -2.0, 1.0)]));
    assert_eq!(analyzer.shear_rate(), [2.0, 4.0]);
    // Each rate is relative to the previous frame, not to the first.
    analyzer.analyze(&frame(4, 0.75, &[DVec3::X, DVec3::ZERO]));
    assert_eq!(analyzer.shear_rate(), [0.0, 8.0]);
}

#[test]
fn largest_element_has_the_largest_force_and_grasp_force_is_the_sum() {
    let forces = [0.1, 0.5, 0.7, -0.3, 0.7].map(|f| DVec3::new(1.0, -1.0, f));
    let flags = analyze(&[(0.0, &forces)]);
    // The first of two equal elements.
    assert_eq!(flags.largest_element, Some(2));
    assert!((flags.grasp_force - 2.0).abs() < 1e-15);
}

#[test]
fn a_repeated_frame_changes_nothing() {
    let mut analyzer = FlagAnalyzer::new(THRESHOLDS, 1);
    analyzer.analyze(&frame(0, 0.0, &[DVec3::ZERO]));
    let flags = analyzer.analyze(&frame(1, 0.25, &[DVec3::X * 2.0]));
    let rate = analyzer.shear_rate().to_vec();
    assert!(flags.slip);
    assert_eq!(analyzer.analyze(&frame(1, 0.25, &[DVec3::X * 2.0])), flags);
    assert_eq!(analyzer.shear_rate(), rate);
}

#[test]
fn repeated_or_decreasing_stamps_give_no_shear_rate() {
    for stamp in [0.5, 0.25] {
        let flags = analyze(&[(0.5, &[DVec3::ZERO]), (stamp, &[DVec3::X * 100.0])]);
        assert!(!flags.slip);
    }
}

#[test]
fn merged_flags_are_set_if_set_in_any_frame() {
    let quiet = FingerFlags {
        grasp_force: 0.2,
        ..FingerFlags::default()
    };
    let slipping = FingerFlags {
        touch: true,
        slip: true,
        over: true,
        largest_element: Some(3),
        grasp_force: 0.5,
    };
    let before = FingerFlags {
        grasp_force: 0.2,
        ..slipping
    };
    assert_eq!(slipping.then(quiet), before);
    assert_eq!(quiet.then(slipping), slipping);
    let elsewhere = FingerFlags {
        largest_element: Some(7),
        ..quiet
    };
    assert_eq!(slipping.then(elsewhere).largest_element, Some(7));
}
