//! Snapshots of typical situations, and their rendering.

use feeler::control::{FingerFlags, FlagThresholds, Phase};
use feeler::sensor::fingertip::{ElementLayout, LayoutConfig};
pub use feeler_watch::text as screen;
use feeler_watch::{Fault, Finger, Program, ProgramState, Snapshot, TaskState, TimeBase, Torque};
use glam::DVec3;

/// A finger with an unloaded reference fingertip.
pub fn finger(number: usize) -> Finger {
    let elements = ElementLayout::new(&LayoutConfig::default()).elements;
    Finger {
        number,
        flags: FingerFlags::default(),
        thresholds: FlagThresholds {
            touch_force: 0.1,
            over_force: 1.98,
            slip_threshold: 4.45,
        },
        grasp_target: 1.0,
        forces: vec![DVec3::ZERO; elements.len()],
        shear_rates: vec![0.0; elements.len()],
        elements,
        joints: [0.1, 0.5, -0.4].into(),
    }
}

pub fn program(name: &str, finger: Option<usize>) -> Program {
    Program {
        name: name.into(),
        finger,
        version: "0.1.0".into(),
        rate: 100.0,
        age: 0.012,
        received: Some(990),
        lost: 10,
        late: Some(3),
        state: ProgramState::Alive,
    }
}

/// Two fingers that approach a cap.
pub fn idle() -> Snapshot {
    Snapshot {
        title: "cap-closing".into(),
        time: 0.5,
        clock: TimeBase::Simulated { speed: 1.0 },
        task: Some(TaskState {
            phase: Phase::Search,
            stroke: 1,
            strokes: Some(4),
        }),
        fingers: vec![finger(0), finger(1)],
        torque: Some(Torque {
            newest: 0.0002,
            history: vec![0.0; 10],
            interval: 0.2,
        }),
        true_cap_angle: Some(0.0),
        programs: vec![
            program("sensor", Some(0)),
            program("sensor", Some(1)),
            program("hand", None),
            program("rig", None),
        ],
        fault: None,
        hand_listens: true,
        missed: None,
        notice: String::new(),
    }
}

/// Finger 1 slips on the cap while turning it.
pub fn slipping() -> Snapshot {
    let mut snapshot = idle();
    snapshot.task = Some(TaskState {
        phase: Phase::Move,
        stroke: 2,
        strokes: Some(4),
    });
    let finger = &mut snapshot.fingers[1];
    finger.forces[6] = DVec3::new(0.3, 0.0, 1.25);
    finger.forces[7] = DVec3::new(0.0, -0.2, 0.4);
    finger.shear_rates[6] = 9.0;
    finger.flags = FingerFlags {
        touch: true,
        slip: true,
        over: false,
        largest_element: Some(6),
        grasp_force: 1.65,
    };
    snapshot.true_cap_angle = Some(0.5);
    snapshot.torque = Some(Torque {
        newest: 0.0213,
        history: vec![0.0, 0.005, 0.01, 0.0213],
        interval: 0.2,
    });
    snapshot
}

/// A stopped hand.
pub fn stopped() -> Snapshot {
    let mut snapshot = slipping();
    snapshot.task = Some(TaskState {
        phase: Phase::Stopped,
        stroke: 2,
        strokes: None,
    });
    snapshot.fault = Some(Fault {
        time: 3.21,
        words: "the forces of finger 1 are 0.0400 s old (limit 0.035 s)".into(),
        over: false,
    });
    snapshot
}

/// A network on which one program is silent and one is refused, without simulation.
pub fn silent() -> Snapshot {
    let mut snapshot = idle();
    snapshot.clock = TimeBase::Real;
    snapshot.true_cap_angle = None;
    snapshot.programs[1].state = ProgramState::Silent;
    snapshot.programs[1].age = 2.5;
    snapshot.programs[1].received = None;
    snapshot.missed = Some(7);
    snapshot.programs[3].state = ProgramState::Refused {
        why: "another experiment".into(),
    };
    snapshot
}
