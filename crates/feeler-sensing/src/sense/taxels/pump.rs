//! Reads rows on a background thread, so that the caller can time out.

use feeler::sensor::forces::{SensorError, TactileFrame, TactileSensor};
use feeler::sensor::taxel::{ProblemCount, TaxelLayout, TaxelSensor};
use feeler_console::CommandError;
use std::io::BufRead;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

/// Maximum number of queued events.
const WAITING: usize = 64;

/// An event from the reading thread.
pub enum Event {
    /// A sequence with this name begins. Only sent if a column contains the names of sequences.
    Sequence(String),
    /// Reading from a row received at `at`.
    Frame { frame: TactileFrame, at: Instant },
    /// A message for the user that is not a problem.
    Note(String),
    /// Description of a problem that occurred for the first time.
    TableProblem(String),
    /// The table ended. Contains number and description of each problem, and the number of skipped lines.
    Ended {
        problems: Vec<(u64, String)>,
        skipped: u64,
    },
    /// Reading failed.
    Failed(String),
}

/// A taxel array read on a background thread.
///
/// The thread ends with its table, or at its next row after the pump is dropped.
pub struct RowPump {
    events: Receiver<Event>,
    used: Sender<TactileFrame>,
}

impl RowPump {
    /// Starts reading `stream`.
    pub fn start(
        stream: Box<dyn BufRead + Send>,
        layout: TaxelLayout,
        rate: Option<f64>,
    ) -> Result<Self, CommandError> {
        Self::spawn(
            move |sender, unused| match TaxelSensor::open(stream, &layout, rate) {
                Ok(sensor) => read_all(sensor, sender, unused),
                Err(error) => Some(Event::Failed(error.to_string())),
            },
        )
    }

    /// Starts a thread that sends events and reuses frames; `read` returns the final event.
    pub fn spawn(
        read: impl FnOnce(&SyncSender<Event>, &Receiver<TactileFrame>) -> Option<Event> + Send + 'static,
    ) -> Result<Self, CommandError> {
        let (sender, events) = sync_channel(WAITING);
        let (used, unused) = channel();
        let run = move || {
            let ended = read(&sender, &unused);
            // The pump may have been dropped.
            let _ = ended.map(|event| sender.send(event));
        };
        thread::Builder::new().name("taxels".into()).spawn(run)?;
        Ok(Self { events, used })
    }

    /// Returns the next event, or `None` if none arrives within `timeout`.
    pub fn next(&self, timeout: Duration) -> Option<Event> {
        match self.events.recv_timeout(timeout) {
            Ok(event) => Some(event),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => {
                Some(Event::Failed("the reading thread has ended".into()))
            }
        }
    }

    /// Returns a frame for reuse.
    pub fn give_back(&self, frame: TactileFrame) {
        // Not needed if reading has ended.
        let _ = self.used.send(frame);
    }
}

/// Reads until the end and returns the final event, or `None` if the receiver was dropped.
fn read_all<R: BufRead>(
    mut sensor: TaxelSensor<R>,
    sender: &SyncSender<Event>,
    unused: &Receiver<TactileFrame>,
) -> Option<Event> {
    let elements = sensor.element_count();
    let mut told = 0;
    loop {
        let new = || TactileFrame::unloaded(elements);
        let mut frame = unused.try_recv().unwrap_or_else(|_| new());
        match sensor.read(&mut frame) {
            Ok(()) => {}
            Err(SensorError::Ended { .. }) => {
                let problems = sensor.problems();
                let words = |problem: &ProblemCount| (problem.count, in_words(&sensor, problem));
                return Some(Event::Ended {
                    problems: problems.iter().map(words).collect(),
                    skipped: problems.skipped(),
                });
            }
            Err(error) => return Some(Event::Failed(error.to_string())),
        }
        let at = Instant::now();
        if sensor.starts_sequence() && !sensor.sequence().is_empty() {
            let name = String::from_utf8_lossy(sensor.sequence()).into_owned();
            sender.send(Event::Sequence(name)).ok()?;
        }
        sender.send(Event::Frame { frame, at }).ok()?;
        let all = sensor.problems().iter();
        for problem in all.filter(|problem| problem.first.line > told) {
            let words = in_words(&sensor, problem);
            sender.send(Event::TableProblem(words)).ok()?;
        }
        told = sensor.line();
    }
}

fn in_words<R: BufRead>(sensor: &TaxelSensor<R>, problem: &ProblemCount) -> String {
    let column = problem.first.column.and_then(|c| sensor.columns().get(c));
    problem.in_words(column.map(String::as_str))
}
