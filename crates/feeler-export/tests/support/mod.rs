//! Recordings that are made up.

#![allow(dead_code, reason = "not every test program needs all of it")]

use feeler::control::phase::Phase;
use feeler_record::{
    Command, Fingertip, Flags, Joints, MemoryRecorder, MessageSink, NO_ELEMENT, Recording,
    RunFacts, Tactile, Task, TaskKind, TorqueSensor, topics,
};
use glam::{DQuat, DVec3};

pub const PERIOD: f64 = 0.01;

/// What is to be made up.
pub struct MadeUp {
    pub fingers: usize,
    pub elements: usize,
    pub steps: usize,
    /// The first step at which forces are known.
    pub felt_from: usize,
    pub period: f64,
}

impl Default for MadeUp {
    fn default() -> Self {
        Self {
            fingers: 1,
            elements: 3,
            steps: 20,
            felt_from: 0,
            period: PERIOD,
        }
    }
}

fn facts(made_up: &MadeUp) -> RunFacts {
    RunFacts {
        experiment: "made-up".into(),
        task: TaskKind::Carry,
        seed: 5,
        version: "0.1.0".into(),
        sensing: "direct".into(),
        law: None,
        control_period: made_up.period,
        fingers: made_up.fingers,
        cap_radius: 0.0,
        feeler_tip_radius: 0.001,
        touch_force_threshold: 0.1,
        over_force_threshold: 1.5,
        slip_threshold: 3.0,
        grasp_force_threshold: 1.0,
        approach: Vec::new(),
        stroke_direction: Vec::new(),
        stroke_count: 1,
        section: Vec::new(),
        truth: Default::default(),
        cap: None,
        carry: None,
        hand: Vec::new(),
        solids: Vec::new(),
        replay_of: None,
    }
}

/// Force on an element at a step, N: a number of its own for each.
pub fn force(step: usize, finger: usize, element: usize) -> DVec3 {
    let number = (step * 100 + finger * 10 + element) as f64;
    DVec3::new(number, -0.5 * number, 1.0 / (1.0 + number))
}

/// A recording of such a run: forces by [`force`], angles that say joint and step.
pub fn recording(made_up: &MadeUp) -> Recording {
    let mut recorder = MemoryRecorder::new(&facts(made_up)).unwrap();
    for step in 0..made_up.steps {
        let stamp = (step + 1) as f64 * made_up.period;
        for finger in 0..made_up.fingers {
            if step >= made_up.felt_from {
                touch(&mut recorder, made_up, (step, finger));
            }
            move_finger(&mut recorder, (step, finger), stamp);
        }
        let torque = TorqueSensor {
            stamp,
            torque: 1e-3 * step as f64,
            ..TorqueSensor::default()
        };
        recorder.write(topics::TORQUE_SENSOR, &torque).unwrap();
        let task = Task {
            stamp,
            phase: if step % 2 == 0 {
                Phase::Search
            } else {
                Phase::Move
            },
            stroke: 1,
            reason: String::new(),
        };
        recorder.write(topics::TASK, &task).unwrap();
    }
    recorder.into_recording()
}

fn touch(recorder: &mut MemoryRecorder, made_up: &MadeUp, (step, finger): (usize, usize)) {
    let stamp = (step + 1) as f64 * made_up.period;
    let forces = (0..made_up.elements).map(|element| force(step, finger, element).into());
    let tactile = Tactile {
        sequence: step as u64,
        stamp,
        forces: forces.collect(),
    };
    let flags = Flags {
        stamp,
        touch: true,
        slip: step % 3 == 0,
        over: false,
        largest_element: if step % 2 == 0 { NO_ELEMENT } else { 1 },
        grasp_force: 0.25,
        shear_rate: vec![0.5; made_up.elements],
    };
    recorder.write(topics::tactile(finger), &tactile).unwrap();
    recorder.write(topics::flags(finger), &flags).unwrap();
}

fn move_finger(recorder: &mut MemoryRecorder, (step, finger): (usize, usize), stamp: f64) {
    let joints = Joints {
        stamp,
        position: [1.0, 2.0, 3.0].map(|joint| joint + 0.001 * step as f64),
        velocity: [0.1; 3],
    };
    let command = Command {
        stamp,
        joint_velocity: [0.1, 0.2, 0.3],
        ..Command::default()
    };
    let fingertip = Fingertip {
        stamp,
        position: DVec3::ZERO.into(),
        orientation: DQuat::IDENTITY.into(),
    };
    recorder.write(topics::joints(finger), &joints).unwrap();
    recorder.write(topics::command(finger), &command).unwrap();
    recorder
        .write(topics::fingertip(finger), &fingertip)
        .unwrap();
}

/// A file for the test called `name`.
pub fn path(name: &str) -> std::path::PathBuf {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("export");
    std::fs::create_dir_all(&folder).unwrap();
    folder.join(name)
}
