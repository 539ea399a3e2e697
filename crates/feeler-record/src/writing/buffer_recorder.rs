//! Recorder that builds the recording's file in memory.

use super::batch::Batch;
use super::memory::MessageSink;
use super::options::RecordOptions;
use super::sink::Sink;
use super::writer::{End, Store};
use crate::error::RecordError;
use crate::messages::facts::RunFacts;
use crate::messages::recorded::RecordedMessage;
use crate::messages::run_end::RunEnd;
use crate::messages::topic::{Channel, RecordedTopic};
use crate::reading::digest::Digest;
use std::io;
use std::mem::take;
use std::sync::{Arc, Mutex, PoisonError};

/// Builds the bytes of a recording's file in memory, without a thread: for programs without files, as in a browser.
///
/// The bytes equal those that a [`Recorder`](crate::Recorder) writes with the same options.
pub struct BufferRecorder {
    channels: Vec<Channel>,
    fingers: usize,
    sink: Sink,
    file: Buffer,
    batch: Batch,
    /// Run time after which a chunk is written (ns).
    flush_interval: u64,
}

impl BufferRecorder {
    /// Creates a recorder for the run described by `facts`, with `options` for additional content and for buffering.
    ///
    /// # Errors
    /// If the facts are invalid.
    pub fn new(
        facts: &RunFacts,
        experiment_toml: &str,
        options: &RecordOptions,
    ) -> Result<Self, RecordError> {
        let channels = Channel::of_run(facts, options.pictures);
        let file = Buffer::default();
        let output = Box::new(file.clone());
        Ok(Self {
            sink: Sink::to_output(output, facts, experiment_toml, options, &channels)?,
            channels,
            fingers: facts.fingers,
            file,
            batch: Batch::default(),
            flush_interval: (options.flush_interval * 1e9) as u64,
        })
    }

    /// Writes the end record of a run that took `wall_time` (s; `None` if not measured) and ended with `run_end`.
    /// Returns the file's bytes and the digest of the run.
    ///
    /// # Errors
    /// If the last messages cannot be encoded.
    pub fn finish(
        mut self,
        wall_time: Option<f64>,
        run_end: RunEnd,
    ) -> Result<(Vec<u8>, Digest), RecordError> {
        self.sink.write(&self.batch)?;
        let digest = self.sink.close(&End {
            wall_time,
            run_end: Some(run_end),
            dropped: 0,
        })?;
        Ok((self.file.take(), digest))
    }
}

impl MessageSink for BufferRecorder {
    fn is_for_viewers(&self) -> bool {
        true
    }

    fn write<M: RecordedMessage>(
        &mut self,
        topic: RecordedTopic<M>,
        message: &M,
    ) -> Result<(), RecordError> {
        let (channels, batch) = (&self.channels, &mut self.batch);
        batch.push(channels, self.fingers, topic, message)
    }

    fn step_ends(&mut self) -> Result<bool, RecordError> {
        if self.batch.is_full(self.flush_interval) {
            self.sink.write(&self.batch)?;
            self.batch.clear();
        }
        Ok(true)
    }
}

/// Bytes that are shared between the recorder and its sink.
#[derive(Clone, Default)]
struct Buffer(Arc<Mutex<Vec<u8>>>);

impl Buffer {
    fn take(&self) -> Vec<u8> {
        take(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl io::Write for Buffer {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut file = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        file.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
