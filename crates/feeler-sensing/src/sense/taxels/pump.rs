//! Reads rows on a thread of its own, so that who waits for one can give up waiting.

use feeler::sensor::reading::{SensorError, TactileFrame, TactileSensor};
use feeler::sensor::taxel::{Seen, TaxelLayout, TaxelSensor};
use feeler_console::CommandError;
use std::io::BufRead;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

/// Frames that may wait.
const WAITING: usize = 64;

/// What came of reading.
pub enum Event {
    /// A sequence of this name begins, where a column names it.
    Sequence(String),
    /// A row was sensed, which came in at `at`.
    Frame { frame: TactileFrame, at: Instant },
    /// Something was not as it should be for the first time, in words.
    Trouble(String),
    /// There is no further row: what was not as it should be, how often and in words, and how many lines were skipped.
    Ended {
        troubles: Vec<(u64, String)>,
        skipped: u64,
    },
    /// Reading failed.
    Failed(String),
}

/// A taxel array on a thread of its own, which ends with its table, or at its next row after the pump is dropped.
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
        let (sender, events) = sync_channel(WAITING);
        let (used, unused) = channel();
        let run = move || {
            let ended = match TaxelSensor::open(stream, &layout, rate) {
                Ok(sensor) => read_all(sensor, &sender, &unused),
                Err(error) => Some(Event::Failed(error.to_string())),
            };
            // Where nobody listens any more, nobody needs to know.
            let _ = ended.map(|event| sender.send(event));
        };
        thread::Builder::new().name("taxels".into()).spawn(run)?;
        Ok(Self { events, used })
    }

    /// What comes next: none if there is nothing within `timeout`.
    pub fn next(&self, timeout: Duration) -> Option<Event> {
        match self.events.recv_timeout(timeout) {
            Ok(event) => Some(event),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => {
                Some(Event::Failed("the thread that reads it has ended".into()))
            }
        }
    }

    /// Gives a frame back to be filled again.
    pub fn give_back(&self, frame: TactileFrame) {
        // Where reading has ended, nobody needs it.
        let _ = self.used.send(frame);
    }
}

/// Reads until the end, which it returns, or until nobody listens.
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
                let troubles = sensor.troubles();
                let words = |seen: &Seen| (seen.count, in_words(&sensor, seen));
                return Some(Event::Ended {
                    troubles: troubles.iter().map(words).collect(),
                    skipped: troubles.skipped(),
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
        let all = sensor.troubles().iter();
        for seen in all.filter(|seen| seen.first.line > told) {
            let words = in_words(&sensor, seen);
            sender.send(Event::Trouble(words)).ok()?;
        }
        told = sensor.line();
    }
}

fn in_words<R: BufRead>(sensor: &TaxelSensor<R>, seen: &Seen) -> String {
    let column = seen.first.column.and_then(|c| sensor.columns().get(c));
    seen.in_words(column.map(String::as_str))
}
