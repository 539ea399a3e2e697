//! Writes a recording during a run.

use super::closing::CloseDeadline;
use super::memory::MessageSink;
use super::options::{Backpressure, RecordOptions};
use super::sink::Sink;
use super::writer::{End, Store, Writer};
use crate::error::RecordError;
use crate::messages::channels::RecordingGap;
use crate::messages::facts::RunFacts;
use crate::messages::recorded::RecordedMessage;
use crate::messages::run_end::RunEnd;
use crate::messages::topic::{Channel, RecordedTopic, topics};
use crate::reading::digest::Digest;
use std::path::Path;
use std::time::Duration;

/// Writes the recording of one run.
///
/// A write only encodes the message; a background thread computes the digest and writes the file, so that the control
/// loop is not blocked. Messages are written in whole chunks of 512 KiB, or of [`RecordOptions::flush_interval`] if
/// that is less, so the file of an interrupted run is readable up to its last chunk. A recorder that is dropped without
/// [`finish`](Self::finish) leaves a file that contains every message and is marked as not closed.
///
/// [`Backpressure`] determines what happens if the file accepts no data.
pub struct Recorder {
    channels: Vec<Channel>,
    fingers: usize,
    pub(crate) writer: Writer,
    patience: Backpressure,
    /// Run time after which a chunk is written (ns).
    flush_interval: u64,
    /// `true` once [`MessageSink::step_ends`] was called. Chunks and gaps then consist of whole steps.
    in_steps: bool,
    run_end: Option<RunEnd>,
}

impl Recorder {
    /// Creates the file. An existing file is overwritten.
    ///
    /// # Errors
    /// If the facts are invalid or the file cannot be written.
    pub fn create(
        path: impl AsRef<Path>,
        facts: &RunFacts,
        experiment_toml: &str,
    ) -> Result<Self, RecordError> {
        Self::create_with(path, facts, experiment_toml, &RecordOptions::default())
    }

    /// Like [`create`](Self::create), with `options` for additional content and for buffering.
    ///
    /// # Errors
    /// See [`create`](Self::create).
    pub fn create_with(
        path: impl AsRef<Path>,
        facts: &RunFacts,
        experiment_toml: &str,
        options: &RecordOptions,
    ) -> Result<Self, RecordError> {
        let path = path.as_ref();
        let mut channels = Channel::of_run(facts, options.pictures);
        channels.extend(options.felt.then(|| Channel::from(topics::FELT)));
        if options.efforts {
            channels.extend(Channel::of_efforts(facts));
        }
        if options.samples {
            channels.extend(Channel::of_samples(facts.fingers));
        }
        let sink = Sink::create(path, facts, experiment_toml, options, &channels)?;
        Self::to_store(path, sink, (channels, facts.fingers), options)
    }

    /// Creates a recorder that writes messages of `channels` to `store`, the file at `path`, for a rig of `fingers`
    /// fingers.
    pub(crate) fn to_store(
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

    /// Sets how the run ended, which [`finish`](Self::finish) writes. Otherwise, readers derive it from the task's
    /// state.
    pub fn set_end(&mut self, end: RunEnd) {
        self.run_end = Some(end);
    }

    /// Number of messages dropped so far because the file was too slow or failed.
    pub fn dropped(&self) -> u64 {
        self.writer.dropped
    }

    /// Messages dropped since the file last accepted data, or `None` if it accepts data.
    pub fn gap(&self) -> Option<&RecordingGap> {
        self.writer.gap.as_ref()
    }

    /// Error of the file, for a recorder of [limited patience](Backpressure::Limited). The file contains everything written
    /// before the error.
    pub fn failure(&self) -> Option<&RecordError> {
        self.writer.failure.as_ref()
    }

    /// Writes wall time (s; `None` if not measured), digest and how the run ended, and closes the file. Takes up to 5 s
    /// for a recorder of limited patience.
    ///
    /// # Errors
    /// If the file cannot be written, or an earlier write failed.
    pub fn finish(self, wall_time: Option<f64>) -> Result<Digest, RecordError> {
        let mut closing = CloseDeadline::of(self.patience);
        self.close(wall_time, &mut closing)
    }

    /// Like [`finish`](Self::finish), but takes up to `limit`. Calls `on_slow` once if closing takes longer than a
    /// second.
    ///
    /// # Errors
    /// See [`finish`](Self::finish). [`RecordError::NotClosed`] if the file accepts no data within `limit`; it is then
    /// left without its end.
    pub fn finish_within(
        self,
        wall_time: Option<f64>,
        limit: Duration,
        on_slow: impl FnOnce(),
    ) -> Result<Digest, RecordError> {
        self.close(wall_time, &mut CloseDeadline::within(limit, on_slow))
    }

    fn close(
        mut self,
        wall_time: Option<f64>,
        closing: &mut CloseDeadline<'_>,
    ) -> Result<Digest, RecordError> {
        let end = End {
            wall_time,
            run_end: self.run_end.take(),
            dropped: 0,
        };
        let digest = self.writer.finish(Some(end), closing)?;
        digest.ok_or_else(|| self.writer.closed())
    }

    /// Sends the batch to the writer if it is large or old enough for a chunk. Returns `false` if messages were
    /// dropped.
    fn send_if_full(&mut self) -> Result<bool, RecordError> {
        if !self.writer.batch.is_full(self.flush_interval) {
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
        let (channels, batch) = (&self.channels, &mut self.writer.batch);
        batch.push(channels, self.fingers, topic, message)?;
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
