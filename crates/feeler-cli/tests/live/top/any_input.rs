//! Arbitrary terminal sizes and values do not break the screen.

use super::scenes::{finger, idle, program, screen, slipping, stopped};
use feeler::control::{FingerFlags, FlagThresholds, Phase};
use feeler::sensor::fingertip::SensingElement;
use feeler_watch::{Fault, Finger, Program, ProgramState, Snapshot, TaskState, TimeBase, Torque};
use glam::{DMat3, DVec3};
use proptest::collection::vec;
use proptest::prelude::*;

#[test]
fn every_small_size_is_drawn() {
    let mut five = slipping();
    five.fingers = vec![five.fingers[1].clone(); 5];
    for snapshot in [Snapshot::default(), idle(), stopped(), five] {
        for width in 0..30 {
            for height in 0..30 {
                screen(&snapshot, width, height);
            }
        }
        for (width, height) in [(1, 200), (300, 1), (300, 100), (39, 24), (80, 12)] {
            screen(&snapshot, width, height);
        }
    }
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<f64>(),
        -3.0..3.0,
        Just(0.0),
        Just(f64::NAN),
        Just(f64::INFINITY)
    ]
}

fn vector() -> impl Strategy<Value = DVec3> {
    [number(), number(), number()].prop_map(DVec3::from_array)
}

fn element() -> impl Strategy<Value = SensingElement> {
    let wild = [vector(), vector(), vector()].prop_map(|[x, y, z]| SensingElement {
        ring: 0,
        rotation: DMat3::from_cols(x, y, z),
    });
    prop_oneof![wild, vector().prop_map(SensingElement::facing)]
}

prop_compose! {
    /// A finger with implausible values and lists of arbitrary lengths.
    fn any_finger()(
        number in any::<usize>(),
        [touch, slip, over] in any::<[bool; 3]>(),
        largest_element in proptest::option::of(0_usize..60),
        [touch_force, over_force, slip_threshold, grasp_target, grasp_force]
            in [number(), number(), number(), number(), number()],
        elements in vec(element(), 0..50),
        forces in vec(vector(), 0..50),
        shear_rates in vec(self::number(), 0..50),
        joints in [self::number(), self::number(), self::number()],
    ) -> Finger {
        Finger {
            number,
            flags: FingerFlags { touch, slip, over, largest_element, grasp_force },
            thresholds: FlagThresholds { touch_force, over_force, slip_threshold },
            grasp_target,
            elements,
            forces,
            shear_rates,
            joints: joints.into(),
        }
    }
}

prop_compose! {
    fn any_program()(
        name in "\\PC{0,20}",
        finger in proptest::option::of(any::<usize>()),
        [rate, age] in [number(), number()],
        received in any::<Option<u64>>(),
        lost in any::<u64>(),
        late in any::<Option<u64>>(),
        state in prop_oneof![
            Just(ProgramState::Silent),
            "\\PC{0,40}".prop_map(|why| ProgramState::Refused { why }),
        ],
    ) -> Program {
        Program { name, finger, rate, age, received, lost, late, state, ..program("", None) }
    }
}

prop_compose! {
    fn any_snapshot()(
        fingers in vec(any_finger(), 0..6),
        programs in vec(any_program(), 0..12),
        history in vec(number(), 0..300),
        [time, speed, newest, interval, cap] in [number(), number(), number(), number(), number()],
        phase in (0_u8..6).prop_map(|number| Phase::try_from(number).unwrap_or_default()),
        [stroke, strokes] in any::<[u32; 2]>(),
        (title, words, notice) in ("\\PC{0,60}", "\\PC{0,200}", "\\PC{0,100}"),
        (over, missed) in any::<(bool, Option<u64>)>(),
    ) -> Snapshot {
        Snapshot {
            title,
            time,
            clock: TimeBase::Simulated { speed },
            task: Some(TaskState { phase, stroke, strokes: Some(strokes) }),
            fingers,
            torque: Some(Torque { newest, history, interval }),
            true_cap_angle: Some(cap),
            programs,
            fault: Some(Fault { time, words, over }),
            hand_listens: true,
            missed,
            notice,
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn every_snapshot_is_drawn(snapshot in any_snapshot(), width in 0_u16..160, height in 0_u16..60) {
        screen(&snapshot, width, height);
    }
}

/// An invalid force does not hide the valid ones.
#[test]
fn invalid_force_is_marked_and_valid_ones_are_shown() {
    let mut snapshot = slipping();
    snapshot.fingers[1].forces[3] = DVec3::NAN;
    let screen = screen(&snapshot, 80, 24);
    assert!(screen.contains('?') && screen.contains('◉'), "{screen}");
    assert!(screen.contains("▸ 6   1.25"), "{screen}");
    assert_eq!(finger(0).elements.len(), 41);
}
