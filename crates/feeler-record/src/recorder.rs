//! Writes a run's recording as the run goes.

use super::container::{find, log_time};
use super::digest::Digest;
use super::error::RecordError;
use super::facts::RunFacts;
use super::memory::MessageSink;
use super::run_end::RunEnd;
use super::sink::{Batch, Entry, Sink};
use super::topic::{Channel, RecordedMessage, RecordedTopic};
use crate::wire::cdr;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, channel, sync_channel};
use std::thread::{self, JoinHandle};

/// Bytes of messages that make a chunk. More would be lost with a program that is killed; of each, the writer keeps
/// 0.6 KB for the index at the end.
const CHUNK_BYTES: usize = 512 * 1024;

/// Room of a batch: a chunk and the message that filled it.
const BATCH_ROOM: usize = CHUNK_BYTES + 16 * 1024;

/// Chunks that may wait for the file before a write waits, too.
const WAITING_CHUNKS: usize = 4;

/// What a recording holds beside the messages that every run has.
#[derive(Debug, Clone, Default)]
pub struct RecordOptions {
    /// The text of each calibration file that the experiment names, by that name. They are no part of the
    /// digest: another calibration shows in the forces.
    pub calibrations: BTreeMap<String, String>,
    /// Whether there will be pictures.
    pub pictures: bool,
}

/// Writes one run's recording.
///
/// A write only encodes the message; digest and the file itself are a thread's work,
/// so that the control loop waits for none of them. Chunks reach the file as they fill (512 KiB),
/// each whole, so an interrupted run leaves a file that is readable up to its last chunk. A
/// recorder that is dropped without [`finish`](Self::finish) leaves a file with every message,
/// marked as not closed.
pub struct Recorder {
    path: PathBuf,
    channels: Vec<Channel>,
    fingers: usize,
    batch: Batch,
    /// Batches that have been written and can be filled again.
    spare: Receiver<Batch>,
    thread: Option<WriterThread>,
    run_end: Option<RunEnd>,
}

struct WriterThread {
    batches: SyncSender<Batch>,
    handle: JoinHandle<Result<Sink, RecordError>>,
}

impl WriterThread {
    /// Waits until everything is written; the file, or why it could not be written.
    fn join(self, path: &Path) -> Result<Sink, RecordError> {
        drop(self.batches);
        let path = path.to_path_buf();
        (self.handle.join()).unwrap_or(Err(RecordError::Closed { path }))
    }
}

impl Recorder {
    /// Creates the file, which must not hold anything of worth: it is overwritten.
    ///
    /// # Errors
    /// When the facts make no sense or the file cannot be written.
    pub fn create(
        path: impl AsRef<Path>,
        facts: &RunFacts,
        experiment_toml: &str,
    ) -> Result<Self, RecordError> {
        Self::create_with(path, facts, experiment_toml, &RecordOptions::default())
    }

    /// Creates the file of a recording that holds more than every one does.
    ///
    /// # Errors
    /// As [`Self::create`].
    pub fn create_with(
        path: impl AsRef<Path>,
        facts: &RunFacts,
        experiment_toml: &str,
        options: &RecordOptions,
    ) -> Result<Self, RecordError> {
        let path = path.as_ref().to_path_buf();
        let channels = Channel::of_run(facts.fingers, options.pictures);
        let calibrations = &options.calibrations;
        let mut sink = Sink::create(&path, facts, experiment_toml, calibrations, &channels)?;
        let (batches, receiver) = sync_channel::<Batch>(WAITING_CHUNKS);
        let (give_back, spare) = channel();
        let write_all = move || {
            for mut batch in receiver {
                sink.write(&batch)?;
                batch.clear();
                // The recorder may be gone already; then nobody needs the memory.
                let _ = give_back.send(batch);
            }
            Ok(sink)
        };
        let thread = thread::Builder::new().name("recorder".into());
        let handle = thread
            .spawn(write_all)
            .map_err(|source| RecordError::File {
                path: path.clone(),
                source,
            })?;
        Ok(Self {
            path,
            channels,
            fingers: facts.fingers,
            batch: Batch::with_capacity(BATCH_ROOM),
            spare,
            thread: Some(WriterThread { batches, handle }),
            run_end: None,
        })
    }

    /// Sets how the run ended, to be written by [`finish`](Self::finish). Without it, readers take it from the task.
    pub fn set_end(&mut self, end: RunEnd) {
        self.run_end = Some(end);
    }

    /// Writes wall time (s; none if not measured), digest and how the run ended, and closes the file.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn finish(mut self, wall_time: Option<f64>) -> Result<Digest, RecordError> {
        self.send()?;
        match self.thread.take() {
            Some(thread) => {
                let sink = thread.join(&self.path)?;
                sink.close(wall_time, self.run_end.as_ref())
            }
            None => Err(self.closed()),
        }
    }

    /// Hands the batch to the thread; if that has stopped, says why.
    fn send(&mut self) -> Result<(), RecordError> {
        let next = self.spare.try_recv();
        let next = next.unwrap_or_else(|_| Batch::with_capacity(BATCH_ROOM));
        let batch = std::mem::replace(&mut self.batch, next);
        let Some(thread) = &self.thread else {
            return Err(self.closed());
        };
        if thread.batches.send(batch).is_ok() {
            return Ok(());
        }
        let stopped = self.thread.take().map(|thread| thread.join(&self.path));
        match stopped {
            Some(Err(error)) => Err(error),
            _ => Err(self.closed()),
        }
    }

    fn closed(&self) -> RecordError {
        RecordError::Closed {
            path: self.path.clone(),
        }
    }
}

impl MessageSink for Recorder {
    fn write<M: RecordedMessage>(
        &mut self,
        topic: RecordedTopic<M>,
        message: &M,
    ) -> Result<(), RecordError> {
        let channel = find(&self.channels, self.fingers, topic)?;
        let log_time = log_time(topic, message)?;
        cdr::encode(message, &mut self.batch.bytes)?;
        self.batch.messages.push(Entry {
            channel,
            log_time,
            end: self.batch.bytes.len(),
        });
        if self.batch.bytes.len() < CHUNK_BYTES {
            return Ok(());
        }
        self.send()
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        // Without `finish` nobody asks what became of the rest; reading says it was not closed.
        let _ = self.send();
        let _ = self.thread.take().map(|thread| thread.join(&self.path));
    }
}
