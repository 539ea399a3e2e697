//! A recording with missing messages after the disk accepted no data for a while, simulated by a pipe without a reader.

use crate::program::{folder, run, whole_run};
use feeler_record::{
    Backpressure, MessageSink, RecordError, RecordOptions, Recorder, Recording, topics,
};
use std::fs::{self, File};
use std::io::Read;
use std::path::Path;
use std::process::Command;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

/// Writes a recorded control step, without the instruments.
fn write_step(recorder: &mut Recorder, from: &Recording, step: usize) -> Result<(), RecordError> {
    for (index, finger) in from.fingers.iter().enumerate() {
        recorder.write(topics::tactile(index), &finger.tactile[step])?;
        recorder.write(topics::flags(index), &finger.flags[step])?;
        recorder.write(topics::joints(index), &finger.joints[step])?;
        recorder.write(topics::command(index), &finger.command[step])?;
        recorder.write(topics::fingertip(index), &finger.fingertip[step])?;
    }
    recorder.write(topics::TASK, &from.task[step])?;
    recorder.step_ends().map(|_| ())
}

/// Everything written to the pipe at `path`. Reading starts after a message from `go`.
fn read_late(path: &Path, go: &Receiver<()>) -> Vec<u8> {
    let mut pipe = File::open(path).expect("the pipe");
    go.recv().expect("the start");
    let mut bytes = Vec::new();
    pipe.read_to_end(&mut bytes).expect("a recording");
    bytes
}

/// Records the run `from` again at `path`, with a gap.
fn with_gap(from: &Recording, path: &Path) {
    let pipe = path.with_extension("pipe");
    let made = Command::new("mkfifo").arg(&pipe).status();
    assert!(made.expect("mkfifo").success());
    let (go, going) = channel();
    let reader = {
        let pipe = pipe.clone();
        std::thread::spawn(move || read_late(&pipe, &going))
    };
    let options = RecordOptions {
        patience: Backpressure::Limited(Duration::ZERO),
        flush_interval: 0.05,
        ..RecordOptions::default()
    };
    let (facts, text) = (&from.facts, &from.experiment);
    let mut recorder = Recorder::create_with(&pipe, facts, text, &options).unwrap();
    let steps = from.task.len();
    let mut step = 0;
    while step < steps / 2 || recorder.gap().is_none() {
        write_step(&mut recorder, from, step).unwrap();
        step += 1;
    }
    go.send(()).unwrap();
    for step in step..steps {
        write_step(&mut recorder, from, step).unwrap();
        // From here on, the disk is fast enough.
        std::thread::sleep(Duration::from_micros(200));
    }
    assert!(recorder.dropped() > 0);
    recorder.set_end(from.end.clone());
    recorder.finish(None).unwrap();
    fs::write(path, reader.join().unwrap()).unwrap();
}

#[test]
fn gap_is_reported_by_all_readers() {
    let folder = folder("gap");
    let path = whole_run(&folder).join("recording.mcap");
    let whole = Recording::read(&path).unwrap();
    with_gap(&whole, &path);
    let recording = Recording::read(&path).unwrap();
    let before = recording.gaps[0].steps_before;
    assert!(before > 0 && before < recording.task.len());
    // Every recorded step is complete: all lists have the gap in the same place.
    for finger in &recording.fingers {
        let stamps = finger.joints.iter().map(|joints| joints.stamp);
        assert!(stamps.eq(recording.task.iter().map(|task| task.stamp)));
    }
    let missing = whole.task.len() - recording.task.len();
    let messages: u64 = recording.gaps.iter().map(|gap| gap.missing.messages).sum();
    assert_eq!(messages, 11 * missing as u64);

    let missing = format!("{messages} messages are missing");
    let said = run(&folder, &["report", "run"]).refused(&["incomplete", &missing]);
    assert!(!said.contains("damaged"), "{said}");
    let page = fs::read_to_string(folder.join("run/report.html")).unwrap();
    assert!(page.contains(&format!("GAP: {missing}")));
    let replayed = run(&folder, &["replay", "run", "--from", "forces"]);
    let until = format!("{before} recorded steps of 2 fingers");
    assert!(replayed.stdout.contains(&until), "{replayed:?}");
    assert!(replayed.stdout.contains("bit for bit"), "{replayed:?}");
    replayed.refused(&[&missing, "because a gap follows"]);
}
