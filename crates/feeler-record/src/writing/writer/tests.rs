//! Files that accept no data for some time, or fail.

use super::*;
use crate::messages::facts::RunFacts;
use crate::messages::topic::{Channel, topics};
use crate::reading::recording::Recording;
use crate::writing::memory::MessageSink;
use crate::writing::options::RecordOptions;
use crate::writing::recorder::Recorder;
use crate::writing::sink::Sink;
use crate::{Joints, RunState, Task};
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex};

/// Long enough that a test that waits for it is noticed.
const FOR_EVER: Duration = Duration::from_secs(3600);

/// Drops messages immediately if the queue is full.
const HURRY: Backpressure = Backpressure::Limited(Duration::ZERO);

/// A store that accepts one batch per permit, and all batches once the permit sender is dropped.
struct Gated<S> {
    permits: Receiver<()>,
    store: S,
    /// `true` if a batch waits for its permit.
    begun: Arc<AtomicBool>,
}

impl<S: Store> Store for Gated<S> {
    fn write(&mut self, batch: &Batch) -> Result<(), RecordError> {
        self.begun.store(true, Ordering::Relaxed);
        let _ = self.permits.recv();
        self.store.write(batch)
    }

    fn close(self, end: &End) -> Result<Digest, RecordError> {
        let _ = self.permits.recv();
        self.store.close(end)
    }
}

/// Content written to a store: the time (ns) of each message, and gaps.
#[derive(Debug, Clone, PartialEq)]
enum Taken {
    Message(u64),
    Gap(RecordingGap),
}

#[derive(Clone, Default)]
struct Memory(Arc<Mutex<Vec<Taken>>>);

impl Store for Memory {
    fn write(&mut self, batch: &Batch) -> Result<(), RecordError> {
        let mut taken = self.0.lock().unwrap();
        taken.extend(batch.gap.map(Taken::Gap));
        let times = batch.messages.iter().map(|entry| entry.log_time);
        taken.extend(times.map(Taken::Message));
        Ok(())
    }

    fn close(self, _: &End) -> Result<Digest, RecordError> {
        Ok(crate::reading::digest::Digester::default().finish())
    }
}

/// A disk that is full after this number of batches.
struct Full(usize);

impl Store for Full {
    fn write(&mut self, _: &Batch) -> Result<(), RecordError> {
        let left = self.0.checked_sub(1);
        self.0 = left.ok_or_else(|| RecordError::File {
            path: "recording.mcap".into(),
            source: std::io::ErrorKind::StorageFull.into(),
        })?;
        Ok(())
    }

    fn close(self, _: &End) -> Result<Digest, RecordError> {
        Ok(crate::reading::digest::Digester::default().finish())
    }
}

/// Time (ns) from the first to the last message of each batch.
#[derive(Clone, Default)]
struct Spans(Arc<Mutex<Vec<u64>>>);

impl Store for Spans {
    fn write(&mut self, batch: &Batch) -> Result<(), RecordError> {
        self.0.lock().unwrap().push(batch.span());
        Ok(())
    }

    fn close(self, _: &End) -> Result<Digest, RecordError> {
        Ok(crate::reading::digest::Digester::default().finish())
    }
}

/// Creates a recorder for two fingers that writes every step to `store` as a chunk.
fn recorder(store: impl Store, patience: Backpressure) -> Recorder {
    let options = RecordOptions {
        patience,
        flush_interval: 0.0,
        ..RecordOptions::default()
    };
    let channels = (Channel::of_run(&facts(), false), 2);
    Recorder::to_store(Path::new("recording.mcap"), store, channels, &options).unwrap()
}

fn gated<S: Store>(store: S, patience: Backpressure) -> (Recorder, Sender<()>) {
    let (recorder, permit, _) = gate(store, patience);
    (recorder, permit)
}

/// Like [`gated`], but returns once step 0 is waiting for its permit, so that the queue's free space is known.
fn held_up<S: Store>(store: S, patience: Backpressure) -> (Recorder, Sender<()>) {
    let (mut recorder, permit, begun) = gate(store, patience);
    write_step(&mut recorder, 0).unwrap();
    while !begun.load(Ordering::Relaxed) {
        thread::yield_now();
    }
    (recorder, permit)
}

/// Creates a recorder whose store performs one write per permit sent. Returns the sender of permits and the flag of
/// [`Gated::begun`].
fn gate<S: Store>(store: S, patience: Backpressure) -> (Recorder, Sender<()>, Arc<AtomicBool>) {
    let (permit, permits) = channel();
    let begun = Arc::<AtomicBool>::default();
    let gated = Gated {
        permits,
        store,
        begun: Arc::clone(&begun),
    };
    (recorder(gated, patience), permit, begun)
}

/// Writes the two messages of step `step` (10 ms each). Returns `false` if messages were dropped.
fn write_step(recorder: &mut Recorder, step: usize) -> Result<bool, RecordError> {
    let stamp = step as f64 * 0.01;
    let joints = Joints {
        stamp,
        ..Joints::default()
    };
    let task = Task {
        stamp,
        ..Task::default()
    };
    recorder.write(topics::joints(0), &joints)?;
    recorder.write(topics::TASK, &task)?;
    recorder.step_ends()
}

/// No batch is allocated while the disk hangs.
#[test]
fn batches_of_a_moving_hand_are_preallocated() {
    let (mut recorder, _permit) = gated(Memory::default(), HURRY);
    let made = recorder.writer.spares.len();
    assert_eq!(made, WAITING_BATCHES + 1);
    // From here on, each step is a batch.
    assert!(recorder.step_ends().unwrap());
    let mut sent = 0;
    while write_step(&mut recorder, sent).unwrap() {
        sent += 1;
        assert_eq!(recorder.writer.spares.len(), made - sent);
    }
    assert!(sent >= WAITING_BATCHES);
    recorder.writer.queue = None;
}

#[test]
fn old_messages_are_written_with_whole_steps() {
    let spans = Spans::default();
    let options = RecordOptions {
        flush_interval: 0.1,
        ..RecordOptions::default()
    };
    let channels = (Channel::of_run(&facts(), false), 2);
    let recorder = Recorder::to_store(Path::new("a.mcap"), spans.clone(), channels, &options);
    let mut recorder = recorder.unwrap();
    for step in 0..100 {
        write_step(&mut recorder, step).unwrap();
    }
    recorder.finish(None).unwrap();
    // Chunks of eleven steps of 10 ms, and the rest.
    assert_eq!(
        *spans.0.lock().unwrap(),
        [&[100_000_000; 9][..], &[0]].concat()
    );
}

/// Number of steps that certainly exceeds the queue while the store accepts nothing.
const OVERFLOW: usize = WAITING_BATCHES + 20;

#[test]
fn a_stuck_file_does_not_block_writes() {
    let (mut recorder, permit) = gated(Memory::default(), HURRY);
    // The first step is written before the recorder works in whole steps.
    let kept = (0..OVERFLOW).filter(|&step| write_step(&mut recorder, step).unwrap());
    let kept = kept.count();
    // One batch may already be with the store; the first step makes two.
    assert!(
        (WAITING_BATCHES - 1..=WAITING_BATCHES).contains(&kept),
        "{kept}"
    );
    assert_eq!(recorder.dropped(), 2 * (OVERFLOW - kept) as u64);
    assert!(recorder.failure().is_none());
    let mut said = false;
    let ended = recorder.finish_within(None, Duration::ZERO, || said = true);
    assert!(
        matches!(ended, Err(RecordError::NotClosed { .. })),
        "{ended:?}"
    );
    assert!(!said);
    drop(permit);
}

#[test]
fn a_write_that_may_wait_waits_once_until_there_is_room() {
    let (mut recorder, permit) = held_up(Memory::default(), Backpressure::Limited(FOR_EVER));
    for step in 1..OVERFLOW {
        // Simulates a wait in vain when the queue is first full; a second wait would hang the test.
        recorder.writer.waited |= recorder.dropped() == 0;
        write_step(&mut recorder, step).unwrap();
    }
    assert!(recorder.writer.waited && recorder.dropped() > 0);
    drop(permit);
    let mut step = OVERFLOW;
    while recorder.writer.waited {
        write_step(&mut recorder, step).unwrap();
        step += 1;
        thread::yield_now();
    }
    let dropped = recorder.dropped();
    // From here on, writes wait again, and nothing is dropped.
    for step in step..step + 3 * OVERFLOW {
        assert!(write_step(&mut recorder, step).unwrap());
    }
    assert_eq!(recorder.dropped(), dropped);
    recorder.finish(None).unwrap();
}

#[test]
fn unlimited_patience_loses_nothing() {
    let memory = Memory::default();
    let (mut recorder, permit) = gated(memory.clone(), Backpressure::Unlimited);
    let permits = thread::spawn(move || {
        for _ in 0..OVERFLOW {
            permit.send(()).unwrap();
            thread::yield_now();
        }
    });
    for step in 0..2 * OVERFLOW {
        assert!(write_step(&mut recorder, step).unwrap());
    }
    permits.join().unwrap();
    assert_eq!(recorder.dropped(), 0);
    recorder.finish(None).unwrap();
    assert_eq!(memory.0.lock().unwrap().len(), 4 * OVERFLOW);
}

#[test]
fn a_full_disk_does_not_end_a_run_of_limited_patience() {
    let mut recorder = recorder(Full(3), HURRY);
    let mut step = 0;
    while recorder.failure().is_none() {
        write_step(&mut recorder, step).unwrap();
        step += 1;
        thread::yield_now();
    }
    let dropped = recorder.dropped();
    assert!(!write_step(&mut recorder, step).unwrap());
    assert_eq!(recorder.dropped(), dropped + 2);
    let error = recorder.finish(None).unwrap_err().to_string();
    assert!(
        error.contains("recording.mcap: no storage space"),
        "{error}"
    );
}

#[test]
fn a_full_disk_is_an_error_with_unlimited_patience() {
    let mut recorder = recorder(Full(3), Backpressure::Unlimited);
    let mut steps = 0..;
    let error = loop {
        if let Err(error) = write_step(&mut recorder, steps.next().unwrap()) {
            break error.to_string();
        }
    };
    assert!(error.contains("no storage space"), "{error}");
    let closed = write_step(&mut recorder, steps.next().unwrap()).unwrap_err();
    assert!(matches!(closed, RecordError::Closed { .. }), "{closed}");
    recorder.finish(None).unwrap_err();
}

/// Minimal facts of a run.
fn facts() -> RunFacts {
    let facts = BTreeMap::from(
        [
            ("experiment", "made-up"),
            ("task", "screw"),
            ("seed", "1"),
            ("version", "0.1.0"),
            ("sensing", "direct"),
            ("control_period", "0.01"),
            ("fingers", "2"),
            ("cap_radius", "0.014"),
            ("feeler_tip_radius", "0.001"),
            ("touch_force_threshold", "0.1"),
            ("over_force_threshold", "1.5"),
            ("slip_threshold", "3.0"),
            ("grasp_force_threshold", "1.0"),
            ("approach", "[[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]"),
            ("stroke_direction", "[[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]]"),
            ("stroke_count", "4"),
        ]
        .map(|(key, value)| (key.to_string(), value.to_string())),
    );
    RunFacts::from_map(&facts).unwrap()
}

/// Records [`OVERFLOW`] steps to a file that accepts no data meanwhile, then steps until one is accepted.
fn with_gap(name: &str, patience: Backpressure) -> Recording {
    let path = std::env::temp_dir().join(format!("feeler-{name}-{}", std::process::id()));
    let channels = Channel::of_run(&facts(), false);
    let sink = Sink::create(&path, &facts(), "", &RecordOptions::default(), &channels).unwrap();
    let (mut recorder, permit) = held_up(sink, patience);
    for step in 1..OVERFLOW {
        write_step(&mut recorder, step).unwrap();
    }
    drop(permit);
    let mut last = OVERFLOW;
    while !write_step(&mut recorder, last).unwrap() {
        last += 1;
        thread::yield_now();
    }
    recorder.set_end(crate::RunEnd::DONE);
    recorder.finish(None).unwrap();
    let recording = Recording::read(&path);
    std::fs::remove_file(&path).unwrap();
    recording.unwrap()
}

#[test]
fn the_recording_reports_its_gap() {
    let recording = with_gap("gap", HURRY);
    let [gap] = recording.gaps[..] else {
        panic!("one gap expected: {:?}", recording.gaps);
    };
    // Whole steps are missing; those before and after are recorded.
    let (before, after) = recording.task.split_at(gap.steps_before);
    let step = |stamp: f64| (stamp * 100.0).round() as usize;
    assert_eq!(step(gap.missing.start), before.len());
    assert_eq!(step(gap.missing.end) + 1, step(after[0].stamp));
    let missing = step(gap.missing.end) + 1 - before.len();
    assert_eq!(gap.missing.messages, 2 * missing as u64);
    assert_eq!(recording.fingers[0].joints.len(), recording.task.len());
    assert!(!recording.complete);
    let problem = recording.problem.unwrap();
    assert!(
        problem.contains(&format!("{} messages are missing from 0.0", 2 * missing)),
        "{problem}"
    );
    let reason = recording.end.reason.unwrap();
    assert_eq!(recording.end.state, RunState::Interrupted);
    assert!(reason.ends_with("the run itself: done"), "{reason}");
}

proptest! {
    /// For any timing of the store, every message is written or counted in a gap, in order.
    #[test]
    fn every_message_is_kept_or_counted(moves in proptest::collection::vec(0..4usize, 1..200)) {
        let memory = Memory::default();
        let (mut recorder, permit) = gated(memory.clone(), HURRY);
        let mut steps = 0;
        for a_move in moves {
            match a_move {
                0 => permit.send(()).unwrap(),
                1 => thread::yield_now(),
                _ => {
                    write_step(&mut recorder, steps).unwrap();
                    steps += 1;
                }
            }
        }
        let dropped = recorder.dropped();
        drop(permit);
        recorder.finish(None).unwrap();
        let taken = memory.0.lock().unwrap();
        let (mut next, mut missing) = (0, 0);
        for taken in taken.iter() {
            match taken {
                Taken::Message(time) => {
                    prop_assert_eq!(*time, next / 2 * 10_000_000);
                    next += 1;
                }
                Taken::Gap(gap) => {
                    prop_assert!((gap.start - (next / 2) as f64 * 0.01).abs() < 1e-9);
                    next += gap.messages;
                    missing += gap.messages;
                    prop_assert!((gap.end - (next / 2 - 1) as f64 * 0.01).abs() < 1e-9);
                }
            }
        }
        prop_assert_eq!(next, 2 * steps as u64);
        prop_assert_eq!(missing, dropped);
    }
}
