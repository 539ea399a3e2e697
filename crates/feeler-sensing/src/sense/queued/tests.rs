//! Slow, full and stuck outputs.

use super::*;
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex};

/// An output that accepts one frame per permit, and all frames once the permit sender is dropped.
struct Gated {
    permits: Receiver<()>,
    taken: Arc<Mutex<Vec<u64>>>,
    /// Number of frames after which the disk is full.
    room: usize,
}

impl Output for Gated {
    fn write(&mut self, frame: &FrameReadings) -> Result<(), CommandError> {
        let _ = self.permits.recv();
        let mut taken = self.taken.lock().unwrap();
        if taken.len() == self.room {
            return Err("no space".into());
        }
        taken.push(frame.sequence);
        Ok(())
    }

    fn flush(&mut self) -> Result<(), CommandError> {
        Ok(())
    }

    fn finish(self: Box<Self>, whole: bool) -> Result<Option<PathBuf>, CommandError> {
        Ok((!whole).then(|| "out.csv.part".into()))
    }
}

type Shared<T> = Arc<Mutex<Vec<T>>>;

fn queued(
    room: usize,
) -> (
    Box<BackgroundOutput>,
    Sender<()>,
    Shared<u64>,
    Shared<String>,
) {
    queued_as(Backpressure::DropAndIgnoreErrors, room)
}

fn queued_as(
    full: Backpressure,
    room: usize,
) -> (
    Box<BackgroundOutput>,
    Sender<()>,
    Shared<u64>,
    Shared<String>,
) {
    let (permit, permits) = channel();
    let (taken, said) = (Shared::default(), Shared::<String>::default());
    let gated = Gated {
        permits,
        taken: Arc::clone(&taken),
        room,
    };
    let heard = Arc::clone(&said);
    let say = Box::new(move |line: &str| heard.lock().unwrap().push(line.into()));
    let queued = BackgroundOutput::start(Box::new(gated), full, false, say).unwrap();
    (Box::new(queued), permit, taken, said)
}

fn write(queued: &mut BackgroundOutput, sequence: u64) {
    let frame = FrameReadings {
        sequence,
        stamp: 0.0,
        readings: &[],
        markers: &[],
    };
    queued.write(&frame).unwrap();
}

#[test]
fn a_disk_that_hangs_twice_blocks_no_sensor_and_leaves_a_partial_file() {
    let (mut queued, permit, taken, said) = queued(usize::MAX);
    let mut sequences = 0..;
    let mut write_while = |queued: &mut BackgroundOutput, is_dropping| {
        while queued.is_dropping == is_dropping {
            write(queued, sequences.next().unwrap());
        }
    };
    write_while(&mut queued, false);
    assert!(said.lock().unwrap()[0].contains("the disk accepts no data"));
    permit.send(()).unwrap();
    write_while(&mut queued, true);
    write_while(&mut queued, false);
    drop(permit);
    write_while(&mut queued, true);
    let dropped = queued.dropped;
    let left = queued.finish(true).unwrap();
    assert_eq!(left, Some("out.csv.part".into()));
    let taken = taken.lock().unwrap();
    assert_eq!(taken.len() as u64 + dropped, sequences.next().unwrap());
    assert!(taken.is_sorted());
    // Each resumption reports the frames missing so far.
    let said = said.lock().unwrap();
    let last = format!("output: resumed; {dropped} frames missing so far");
    assert_eq!(said.last(), Some(&last), "{said:?}");
}

#[test]
fn a_complete_file_is_closed_as_complete() {
    let (mut queued, permit, taken, said) = queued(usize::MAX);
    drop(permit);
    for sequence in 0..10 {
        write(&mut queued, sequence);
    }
    assert_eq!(queued.finish(true).unwrap(), None);
    assert_eq!(*taken.lock().unwrap(), (0..10).collect::<Vec<_>>());
    assert!(said.lock().unwrap().is_empty());
}

#[test]
fn a_full_disk_ends_the_file_and_not_the_sensor() {
    let (mut queued, permit, taken, said) = queued(3);
    drop(permit);
    let mut sequence = 0;
    while queued.works.is_some() {
        write(&mut queued, sequence);
        sequence += 1;
        thread::yield_now();
    }
    write(&mut queued, sequence);
    let error = queued.finish(true).unwrap_err().to_string();
    assert!(error.contains("not written completely"), "{error}");
    assert_eq!(taken.lock().unwrap().len(), 3);
    let said = said.lock().unwrap();
    let last = said.last().unwrap();
    assert!(
        last.contains("no space; out.csv.part is partial"),
        "{said:?}"
    );
}
