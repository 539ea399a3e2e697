//! Writes a run's recording as the run goes.

use super::batch::Entry;
use super::channels::RecordingGap;
use super::closing::Closing;
use super::container::{find, log_time};
use super::digest::Digest;
use super::error::RecordError;
use super::facts::RunFacts;
use super::memory::MessageSink;
use super::options::{Patience, RecordOptions};
use super::run_end::RunEnd;
use super::sink::Sink;
use super::topic::{Channel, RecordedMessage, RecordedTopic};
use super::writer::{CHUNK_BYTES, End, Store, Writer};
use crate::wire::cdr;
use std::path::Path;
use std::time::Duration;

/// Writes one run's recording.
///
/// A write only encodes the message; digest and the file itself are a thread's work,
/// so that the control loop waits for none of them. Messages reach the file in chunks of 512 KiB, or of
/// [`RecordOptions::flush_interval`] where that is less, each whole, so an interrupted run leaves a file that is
/// readable up to its last chunk. A
/// recorder that is dropped without [`finish`](Self::finish) leaves a file with every message,
/// marked as not closed.
///
/// What becomes of a run whose file takes nothing, [`Patience`] says.
pub struct Recorder {
    channels: Vec<Channel>,
    fingers: usize,
    pub(super) writer: Writer,
    patience: Patience,
    /// Run's time that makes a chunk, ns.
    flush_interval: u64,
    /// Whether the writer says when steps end, so that chunks, and gaps, begin and end with steps.
    in_steps: bool,
    run_end: Option<RunEnd>,
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

    /// Creates the file of a recording that holds more than every one does, or is written otherwise.
    ///
    /// # Errors
    /// As [`Self::create`].
    pub fn create_with(
        path: impl AsRef<Path>,
        facts: &RunFacts,
        experiment_toml: &str,
        options: &RecordOptions,
    ) -> Result<Self, RecordError> {
        let path = path.as_ref();
        let channels = Channel::of_run(facts, options.pictures);
        let sink = Sink::create(path, facts, experiment_toml, options, &channels)?;
        Self::to_store(path, sink, (channels, facts.fingers), options)
    }

    /// Writes to `store`, the file at `path`, messages of these channels of a rig of so many fingers.
    pub(super) fn to_store(
        path: &Path,
        store: impl Store,
        (channels, fingers): (Vec<Channel>, usize),
        options: &RecordOptions,
    ) -> Result<Self, RecordError> {
        Ok(Self {
            channels,
            fingers,
            writer: Writer::start(path, store, options.patience)?,
            patience: options.patience,
            flush_interval: (options.flush_interval * 1e9) as u64,
            in_steps: false,
            run_end: None,
        })
    }

    /// Sets how the run ended, to be written by [`finish`](Self::finish). Without it, readers take it from the task.
    pub fn set_end(&mut self, end: RunEnd) {
        self.run_end = Some(end);
    }

    /// Messages that were dropped so far, as the file had no room or failed.
    pub fn dropped(&self) -> u64 {
        self.writer.dropped()
    }

    /// What is missing since there was room for the last time; none while there is.
    pub fn gap(&self) -> Option<&RecordingGap> {
        self.writer.gap()
    }

    /// Why the file takes nothing any more, of a recorder of [limited patience](Patience::Limited). Everything up to
    /// then is in it.
    pub fn failure(&self) -> Option<&RecordError> {
        self.writer.failure()
    }

    /// Writes wall time (s; none if not measured), digest and how the run ended, and closes the file. A recorder of
    /// limited patience takes 5 s at most.
    ///
    /// # Errors
    /// When the file cannot be written, or could not be.
    pub fn finish(self, wall_time: Option<f64>) -> Result<Digest, RecordError> {
        let mut closing = Closing::of(self.patience);
        self.close(wall_time, &mut closing)
    }

    /// The same within `limit`; calls `on_slow` when that takes longer than a second.
    ///
    /// # Errors
    /// As [`Self::finish`]; [`RecordError::NotClosed`] where the file takes nothing. It is left as it is.
    pub fn finish_within(
        self,
        wall_time: Option<f64>,
        limit: Duration,
        on_slow: impl FnOnce(),
    ) -> Result<Digest, RecordError> {
        self.close(wall_time, &mut Closing::within(limit, on_slow))
    }

    fn close(
        mut self,
        wall_time: Option<f64>,
        closing: &mut Closing<'_>,
    ) -> Result<Digest, RecordError> {
        let end = End {
            wall_time,
            run_end: self.run_end.take(),
            dropped: 0,
        };
        let digest = self.writer.finish(Some(end), closing)?;
        digest.ok_or_else(|| self.writer.closed())
    }

    /// Hands the batch on if it makes a chunk; whether nothing was dropped.
    fn send_if_full(&mut self) -> Result<bool, RecordError> {
        let batch = &self.writer.batch;
        let is_full = batch.bytes.len() >= CHUNK_BYTES || batch.span() >= self.flush_interval;
        if batch.messages.is_empty() || !is_full {
            return Ok(true);
        }
        self.writer.send()
    }
}

impl MessageSink for Recorder {
    fn is_for_viewers(&self) -> bool {
        true
    }

    fn write<M: RecordedMessage>(
        &mut self,
        topic: RecordedTopic<M>,
        message: &M,
    ) -> Result<(), RecordError> {
        let channel = find(&self.channels, self.fingers, topic)?;
        let log_time = log_time(topic, message)?;
        let batch = &mut self.writer.batch;
        cdr::encode(message, &mut batch.bytes)?;
        batch.messages.push(Entry {
            channel,
            log_time,
            end: batch.bytes.len(),
        });
        if self.in_steps {
            return Ok(());
        }
        self.send_if_full().map(|_| ())
    }

    fn step_ends(&mut self) -> Result<bool, RecordError> {
        self.in_steps = true;
        self.send_if_full()
    }
}
