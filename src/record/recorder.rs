//! Writes a run's recording as the run goes.

use super::cdr;
use super::channels::{
    Cap, Command, Fingertip, Flags, Joints, Message, Tactile, Task, Topic, TorqueSensor,
};
use super::digest::{Digest, Digester};
use super::error::RecordError;
use super::facts::RunFacts;
use ::mcap::records::{MessageHeader, Metadata};
use ::mcap::write::NoSeek;
use ::mcap::{Attachment, Compression, McapError, WriteOptions, Writer};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

/// Name of the metadata record that holds the run's facts, at the file's start.
pub const FACTS: &str = "feeler.run";
/// Name of the metadata record at the file's end: wall time and digest.
pub const END: &str = "feeler.end";
/// Name of the attachment that holds the experiment as run.
pub const EXPERIMENT: &str = "experiment.toml";

/// Uncompressed bytes of messages after which a chunk is closed and handed to the system.
const CHUNK_BYTES: usize = 256 * 1024;

/// Channels of one finger, in the order of [`Topic::all`].
const FINGER_CHANNELS: usize = 5;

/// Writes one run's recording.
///
/// Chunks reach the file as they fill (256 KiB), each whole, so an interrupted run leaves a file
/// that is readable up to its last chunk.
pub struct Recorder {
    path: PathBuf,
    writer: Writer<NoSeek<BufWriter<File>>>,
    channels: Vec<Channel>,
    fingers: usize,
    digester: Digester,
    buffer: Vec<u8>,
    chunk_bytes: usize,
}

struct Channel {
    id: u16,
    topic: String,
    sequence: u32,
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
        let path = path.as_ref().to_path_buf();
        facts.validate()?;
        let file = File::create(&path).map_err(|source| RecordError::File {
            path: path.clone(),
            source,
        })?;
        let options = WriteOptions::new()
            .profile("ros2")
            .library(concat!("feeler ", env!("CARGO_PKG_VERSION")))
            .compression(Some(Compression::Lz4))
            .chunk_size(None)
            .disable_seeking(true);
        let writer = options.create(NoSeek::new(BufWriter::new(file)));
        let mut recorder = Self {
            writer: writer.map_err(|source| mcap_error(&path, source))?,
            path,
            channels: Vec::new(),
            fingers: facts.fingers,
            digester: Digester::default(),
            buffer: Vec::new(),
            chunk_bytes: 0,
        };
        let facts = facts.to_map()?;
        digest_facts(&mut recorder.digester, &facts, experiment_toml);
        recorder
            .start(facts, experiment_toml)
            .map_err(|source| mcap_error(&recorder.path, source))?;
        Ok(recorder)
    }

    /// Writes facts, experiment and channels.
    fn start(
        &mut self,
        facts: BTreeMap<String, String>,
        experiment_toml: &str,
    ) -> Result<(), McapError> {
        self.writer.write_metadata(&Metadata {
            name: FACTS.into(),
            metadata: facts,
        })?;
        self.writer.attach(&Attachment {
            log_time: 0,
            create_time: 0,
            name: EXPERIMENT.into(),
            media_type: "application/toml".into(),
            data: Cow::Borrowed(experiment_toml.as_bytes()),
        })?;
        for topic in Topic::all(self.fingers) {
            let (name, text) = topic.schema();
            let schema = self.writer.add_schema(name, "ros2msg", text.as_bytes())?;
            let topic = topic.name();
            let id = (self.writer).add_channel(schema, &topic, "cdr", &BTreeMap::new())?;
            self.channels.push(Channel {
                id,
                topic,
                sequence: 0,
            });
        }
        self.writer.flush()
    }

    /// Writes a finger's tactile frame.
    ///
    /// # Errors
    /// As all writes: unknown finger, a stamp that is no time, or the file cannot be written.
    pub fn tactile(&mut self, finger: usize, message: &Tactile) -> Result<(), RecordError> {
        self.write(self.finger_channel(finger, 0)?, message)
    }

    /// Writes a finger's flags.
    ///
    /// # Errors
    /// As [`Self::tactile`].
    pub fn flags(&mut self, finger: usize, message: &Flags) -> Result<(), RecordError> {
        self.write(self.finger_channel(finger, 1)?, message)
    }

    /// Writes a finger's encoder reading.
    ///
    /// # Errors
    /// As [`Self::tactile`].
    pub fn joints(&mut self, finger: usize, message: &Joints) -> Result<(), RecordError> {
        self.write(self.finger_channel(finger, 2)?, message)
    }

    /// Writes a finger's command.
    ///
    /// # Errors
    /// As [`Self::tactile`].
    pub fn command(&mut self, finger: usize, message: &Command) -> Result<(), RecordError> {
        self.write(self.finger_channel(finger, 3)?, message)
    }

    /// Writes a fingertip's pose.
    ///
    /// # Errors
    /// As [`Self::tactile`].
    pub fn fingertip(&mut self, finger: usize, message: &Fingertip) -> Result<(), RecordError> {
        self.write(self.finger_channel(finger, 4)?, message)
    }

    /// Writes a sample of the torque sensor.
    ///
    /// # Errors
    /// As [`Self::tactile`].
    pub fn torque_sensor(&mut self, message: &TorqueSensor) -> Result<(), RecordError> {
        self.write(self.fingers * FINGER_CHANNELS, message)
    }

    /// Writes the cap's state.
    ///
    /// # Errors
    /// As [`Self::tactile`].
    pub fn cap(&mut self, message: &Cap) -> Result<(), RecordError> {
        self.write(self.fingers * FINGER_CHANNELS + 1, message)
    }

    /// Writes where the task stands.
    ///
    /// # Errors
    /// As [`Self::tactile`].
    pub fn task(&mut self, message: &Task) -> Result<(), RecordError> {
        self.write(self.fingers * FINGER_CHANNELS + 2, message)
    }

    /// Writes wall time (s; none if not measured) and digest, and closes the file.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn finish(mut self, wall_time: Option<f64>) -> Result<Digest, RecordError> {
        let digest = std::mem::take(&mut self.digester).finish();
        let mut metadata = BTreeMap::from([("digest".to_string(), digest.to_string())]);
        if let Some(seconds) = wall_time {
            metadata.insert("wall_time".into(), seconds.to_string());
        }
        let end = Metadata {
            name: END.into(),
            metadata,
        };
        (self.writer.write_metadata(&end))
            .and_then(|()| self.writer.finish())
            .map_err(|source| mcap_error(&self.path, source))?;
        let mut buffered = self.writer.into_inner().into_inner();
        std::io::Write::flush(&mut buffered).map_err(|source| RecordError::File {
            path: self.path,
            source,
        })?;
        Ok(digest)
    }

    fn finger_channel(&self, finger: usize, channel: usize) -> Result<usize, RecordError> {
        if finger < self.fingers {
            Ok(finger * FINGER_CHANNELS + channel)
        } else {
            Err(RecordError::Finger {
                fingers: self.fingers,
                actual: finger,
            })
        }
    }

    fn write<M: Message>(&mut self, channel: usize, message: &M) -> Result<(), RecordError> {
        let channel = &mut self.channels[channel];
        let stamp = message.stamp();
        let log_time = nanoseconds(stamp).ok_or_else(|| RecordError::Stamp {
            topic: channel.topic.clone(),
            stamp,
        })?;
        cdr::encode(message, &mut self.buffer)?;
        self.digester
            .message(&channel.topic, log_time, &self.buffer);
        let header = MessageHeader {
            channel_id: channel.id,
            sequence: channel.sequence,
            log_time,
            publish_time: log_time,
        };
        channel.sequence = channel.sequence.wrapping_add(1);
        self.chunk_bytes += self.buffer.len();
        (self.writer.write_to_known_channel(&header, &self.buffer))
            .and_then(|()| {
                if self.chunk_bytes < CHUNK_BYTES {
                    return Ok(());
                }
                self.chunk_bytes = 0;
                self.writer.flush()
            })
            .map_err(|source| mcap_error(&self.path, source))
    }
}

/// Takes in the facts and the experiment, as they stand before all messages.
pub(super) fn digest_facts(
    digester: &mut Digester,
    facts: &BTreeMap<String, String>,
    experiment_toml: &str,
) {
    for (key, value) in facts {
        digester.block(key.as_bytes());
        digester.block(value.as_bytes());
    }
    digester.block(experiment_toml.as_bytes());
}

/// A stamp in whole nanoseconds; none if it is no time of a run.
fn nanoseconds(stamp: f64) -> Option<u64> {
    let ns = (stamp * 1e9).round();
    (ns >= 0.0 && ns < u64::MAX as f64).then_some(ns as u64)
}

fn mcap_error(path: &Path, source: McapError) -> RecordError {
    RecordError::Mcap {
        path: path.to_path_buf(),
        source,
    }
}
