//! Synthetic recordings.

#![allow(dead_code, reason = "not every test program uses all items")]

pub mod fast_touch;

use feeler::control::Phase;
use feeler::sensor::image::Frame;
use feeler_record::{
    Command, Fingertip, Flags, Image, Joints, MemoryRecorder, MessageSink, NO_ELEMENT,
    RecordOptions, Recorder, Recording, RunFacts, Tactile, Task, TaskKind, TorqueSensor, topics,
};
use glam::{DQuat, DVec3};
use std::path::{Path, PathBuf};

pub const PERIOD: f64 = 0.01;

/// Parameters of a synthetic recording.
pub struct MadeUp {
    pub fingers: usize,
    pub elements: usize,
    pub steps: usize,
    /// First step with tactile readings.
    pub felt_from: usize,
    pub period: f64,
    /// Width and height of the images (px); `None` for no images.
    pub pictures: Option<(usize, usize)>,
}

impl Default for MadeUp {
    fn default() -> Self {
        Self {
            fingers: 1,
            elements: 3,
            steps: 20,
            felt_from: 0,
            period: PERIOD,
            pictures: None,
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

/// Force on an element at a step (N). It differs between steps, fingers and elements.
pub fn force(step: usize, finger: usize, element: usize) -> DVec3 {
    let number = (step * 100 + finger * 10 + element) as f64;
    DVec3::new(number, -0.5 * number, 1.0 / (1.0 + number))
}

/// Synthetic recording without images. Forces are those of [`force`], and joint angles encode joint and step.
pub fn recording(made_up: &MadeUp) -> Recording {
    let mut recorder = MemoryRecorder::new(&facts(made_up)).unwrap();
    record(&mut recorder, made_up);
    recorder.into_recording()
}

/// Writes a synthetic recording to a file, with images according to [`bar`].
pub fn recording_file(made_up: &MadeUp, path: &Path) {
    let options = RecordOptions {
        pictures: made_up.pictures.is_some(),
        ..RecordOptions::default()
    };
    let recorder = Recorder::create_with(path, &facts(made_up), "", &options);
    let mut recorder = recorder.unwrap();
    record(&mut recorder, made_up);
    recorder.finish(None).unwrap();
}

fn record(recorder: &mut impl MessageSink, made_up: &MadeUp) {
    for step in 0..made_up.steps {
        let stamp = (step + 1) as f64 * made_up.period;
        for finger in 0..made_up.fingers {
            if let Some(size) = made_up.pictures {
                see(recorder, (step, finger), stamp, size);
            }
            if step >= made_up.felt_from {
                touch(recorder, made_up, (step, finger));
            }
            move_finger(recorder, (step, finger), stamp);
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
}

/// First column (px) of the bright bar in an image of this width. It depends on step and finger.
pub fn bar(step: usize, finger: usize, width: usize) -> usize {
    (8 * finger + 4 * step) % (width - BAR)
}

/// Width of the bar (px).
pub const BAR: usize = 8;

fn see(
    recorder: &mut impl MessageSink,
    (step, finger): (usize, usize),
    stamp: f64,
    (width, height): (usize, usize),
) {
    let mut frame = Frame::black(width, height);
    frame.stamp = stamp;
    let first = bar(step, finger, width);
    for row in frame.picture.pixels.chunks_mut(width) {
        row[first..first + BAR].fill(255);
    }
    let mut image = Image::of_finger(finger);
    image.fill(&frame).unwrap();
    recorder.write(topics::image(finger), &image).unwrap();
}

fn touch(recorder: &mut impl MessageSink, made_up: &MadeUp, (step, finger): (usize, usize)) {
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

fn move_finger(recorder: &mut impl MessageSink, (step, finger): (usize, usize), stamp: f64) {
    let joints = Joints {
        stamp,
        position: [1.0, 2.0, 3.0]
            .map(|joint| joint + 0.001 * step as f64)
            .into(),
        velocity: [0.1; 3].into(),
    };
    let command = Command {
        stamp,
        joint_velocity: [0.1, 0.2, 0.3].into(),
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

/// Path of a temporary file with this name.
pub fn path(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("export");
    std::fs::create_dir_all(&folder).unwrap();
    folder.join(name)
}
