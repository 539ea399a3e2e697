//! Replaying a recording through the same sensing and control is bit-identical.

use feeler::control::{ControlError, ControlLoop, FlaggedSensor, Phase, StopReason};
use feeler::hand::HandError;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::replay::{Comparison, Kind, Replay, ReplayFrom, recorded_experiment};
use feeler_lab::experiment::{Session, controller, fingers_at_home, layouts, run_facts};
use feeler_record::wire::Vector3;
use feeler_record::{
    InstrumentRecord, RecordOptions, RecordedHand, RecordedSensor, Recorder, Recording, RunLog,
};
use proptest::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("replay-{name}.mcap"))
}

/// Runs the reference experiment with `settings` and records it at `path`, with images unless sensing is direct.
fn record(settings: &[&str], path: &Path) -> Recording {
    let settings: Vec<_> = settings.iter().map(ToString::to_string).collect();
    let experiment = Experiment::load("cap-closing", &settings).unwrap();
    let pictures = !settings.contains(&"sensing=direct".to_string());
    let options = RecordOptions {
        calibrations: experiment.calibration_texts().unwrap(),
        pictures,
        ..RecordOptions::default()
    };
    let facts = run_facts(&experiment.config).unwrap();
    let recorder = Recorder::create_with(path, &facts, &experiment.toml, &options).unwrap();
    let mut session = Session::new(&experiment).unwrap();
    let mut log = RunLog::new(recorder, &facts).unwrap();
    if pictures {
        log = log.with_pictures();
    }
    while !session.finished() {
        let instruments = session.step().unwrap();
        instruments
            .record(session.control_loop(), &mut log)
            .unwrap();
    }
    log.into_recorder().finish(None).unwrap();
    Recording::read(path).unwrap()
}

fn recorded_run(settings: &[&str], name: &str) -> Recording {
    let path = file(name);
    let recording = record(&[&["sensing=direct"], settings].concat(), &path);
    fs::remove_file(&path).unwrap();
    recording
}

fn replay(recording: &Recording, from: ReplayFrom<'_>, settings: &[String]) -> Comparison {
    let experiment = recorded_experiment(recording, settings).unwrap();
    let mut replay = Replay::new(recording, from, &experiment).unwrap();
    while !replay.finished() {
        replay.step().unwrap();
    }
    replay.finish().0
}

type Loop = ControlLoop<FlaggedSensor<RecordedSensor>, RecordedHand>;

/// Control loop of a recording's experiment with the recorded hand and sensors.
fn control_loop(recording: &Recording) -> Loop {
    let experiment = Experiment::parse(&recording.experiment, "recording", &[], None).unwrap();
    let layouts = layouts(&experiment.config).unwrap();
    let (fingers, _) = fingers_at_home(&experiment.config).unwrap();
    let thresholds = experiment.config.control.thresholds();
    let sensors = (0..fingers.len()).map(|f| RecordedSensor::new(recording, f));
    let sensors = sensors.map(|sensor| FlaggedSensor::new(sensor, thresholds));
    ControlLoop::new(
        sensors.collect(),
        RecordedHand::new(recording),
        controller(&experiment, &fingers, &layouts).expect("a controller"),
    )
}

#[test]
fn a_replayed_recording_gives_the_same_commands() {
    let recording = recorded_run(&["time_limit=4.0"], "commands");
    let mut control_loop = control_loop(&recording);
    let steps = recording.task.len();
    assert!(steps >= 400, "{steps} recorded steps");
    for step in 0..steps {
        control_loop.step().unwrap();
        for (finger, record) in recording.fingers.iter().enumerate() {
            let replayed = control_loop.command().joint_velocity()[finger];
            let recorded = record.command[step].joint_velocity;
            let [replayed, recorded] = [replayed, recorded].map(|v| v.to_array::<3>().unwrap());
            assert_eq!(
                replayed.map(f64::to_bits),
                recorded.map(f64::to_bits),
                "finger {finger}, step {step}"
            );
        }
    }
    let end = control_loop.step();
    assert!(
        matches!(end, Err(ControlError::Hand(HandError::Ended { count })) if count == steps as u64)
    );
}

/// A user stops and resumes the hand twice within a stroke; the recording contains only the task's phases.
#[test]
fn stops_from_outside_are_repeated() {
    let original = recorded_run(&["time_limit=4.0"], "outside-original");
    let (path, steps) = (file("outside"), original.task.len());
    let mut control_loop = control_loop(&original);
    let recorder = Recorder::create(&path, &original.facts, &original.experiment).unwrap();
    let mut log = RunLog::new(recorder, &original.facts).unwrap();
    for step in 0..steps {
        match step {
            0 | 120 | 250 => control_loop.controller_mut().stop(StopReason::Recorded),
            1 | 180 => control_loop.controller_mut().resume(),
            _ => {}
        }
        control_loop.step().unwrap();
        log.write(&control_loop, InstrumentRecord::default())
            .unwrap();
    }
    log.into_recorder().finish(None).unwrap();
    let recording = Recording::read(&path).unwrap();
    fs::remove_file(&path).unwrap();
    let stopped = recording.task.iter().filter(|t| t.phase == Phase::Stopped);
    assert_eq!(stopped.count(), 1 + 60 + steps - 250);
    assert_ne!(recording.fingers[0].command, original.fingers[0].command);
    let comparison = replay(&recording, ReplayFrom::Forces, &[]);
    assert!(comparison.same(), "{comparison:?}");
    assert_eq!(comparison.of(Kind::Phases).compared, steps as u64);
    // Recorded inputs are not compared with themselves.
    assert_eq!(comparison.of(Kind::Forces).compared, 0);
}

/// The control law stops by itself; with another limit it does not, and no other stop is replayed.
#[test]
fn stops_of_the_control_law_are_not_replayed_as_orders() {
    let recording = recorded_run(&["task.screw.search_limit=0.001"], "own-stop");
    assert_eq!(recording.task.last().unwrap().phase, Phase::Stopped);
    let same = replay(&recording, ReplayFrom::Forces, &[]);
    assert!(same.same(), "{same:?}");
    let setting = "task.screw.search_limit=0.012".to_string();
    let comparison = replay(&recording, ReplayFrom::Forces, &[setting]);
    let phases = comparison.of(Kind::Phases);
    assert_eq!(phases.differing, 1);
    let first = phases.first.as_ref().unwrap();
    assert_eq!(
        (&*first.name, &*first.expected, &*first.actual),
        ("phase", "STOPPED", "SEARCH")
    );
}

/// A few steps with images, before the fingers touch anything.
fn with_pictures() -> &'static (Recording, PathBuf) {
    static RECORDING: OnceLock<(Recording, PathBuf)> = OnceLock::new();
    RECORDING.get_or_init(|| {
        let path = file("pictures");
        (record(&["time_limit=0.1"], &path), path)
    })
}

/// Recordings with and without images differ only in the images.
#[test]
fn recording_images_changes_nothing_else() {
    let (seen, _) = with_pictures();
    let path = file("no-pictures");
    let experiment = Experiment::load("cap-closing", &["time_limit=0.1".into()]).unwrap();
    let facts = run_facts(&experiment.config).unwrap();
    let recorder = Recorder::create(&path, &facts, &experiment.toml).unwrap();
    let mut session = Session::new(&experiment).unwrap();
    let mut log = RunLog::new(recorder, &facts).unwrap();
    while !session.finished() {
        let instruments = session.step().unwrap();
        instruments
            .record(session.control_loop(), &mut log)
            .unwrap();
    }
    let digest = log.into_recorder().finish(None).unwrap();
    let plain = Recording::read(&path).unwrap();
    fs::remove_file(&path).unwrap();
    assert!(seen.complete && plain.complete);
    assert_eq!(plain.digest, digest);
    let mut without = seen.clone();
    assert_eq!(without.calibrations.len(), 1);
    without.calibrations.clear();
    without.digest = digest;
    for finger in &mut without.fingers {
        assert_eq!(finger.pictures.len(), finger.tactile.len());
        finger.pictures.clear();
    }
    assert_eq!(without, plain);
}

fn component(force: &mut Vector3, axis: usize) -> (&mut f64, &'static str) {
    match axis {
        0 => (&mut force.x, "x"),
        1 => (&mut force.y, "y"),
        _ => (&mut force.z, "z"),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 16, ..ProptestConfig::default() })]

    #[test]
    fn a_flipped_bit_of_a_recorded_force_is_named(
        step in 0..10usize, finger in 0..2usize, element in 0..41usize, axis in 0..3usize, bit in 0..64u32,
    ) {
        let (recording, path) = with_pictures();
        let mut flipped = recording.clone();
        let force = &mut flipped.fingers[finger].tactile[step].forces[element];
        let (value, name) = component(force, axis);
        *value = f64::from_bits(value.to_bits() ^ 1 << bit);
        let comparison = replay(&flipped, ReplayFrom::Frames(path), &[]);
        let forces = comparison.of(Kind::Forces);
        prop_assert_eq!((forces.compared, forces.differing), (22, 1));
        let first = forces.first.as_ref().unwrap();
        prop_assert_eq!((first.step, first.finger), (step, Some(finger)));
        prop_assert_eq!(&first.name, &format!("forces[{element}].{name}"));
        prop_assert_ne!(&first.expected, &first.actual);
        for kind in [Kind::Flags, Kind::Phases, Kind::Commands] {
            prop_assert_eq!(comparison.of(kind).differing, 0);
        }
    }
}
