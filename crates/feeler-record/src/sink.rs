//! Puts batches of encoded messages into the file; works on the recorder's own thread.

use super::channels::Topic;
use super::digest::{Digest, Digester};
use super::error::RecordError;
use super::facts::RunFacts;
use super::run_end::RunEnd;
use ::mcap::records::{MessageHeader, Metadata};
use ::mcap::write::NoSeek;
use ::mcap::{Attachment, McapError, WriteOptions, Writer};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};

/// Name of the metadata record that holds the run's facts, at the file's start.
pub const FACTS: &str = "feeler.run";
/// Name of the metadata record at the file's end: wall time, digest, and how the run ended.
pub const END: &str = "feeler.end";
/// Name of the attachment that holds the experiment as run.
pub const EXPERIMENT: &str = "experiment.toml";

/// What stands before the experiment's name of a calibration in the name of its attachment.
pub const CALIBRATION: &str = "calibration/";

/// Encoded messages on their way to the file.
pub struct Batch {
    /// The messages' bytes, one after the other.
    pub bytes: Vec<u8>,
    /// Where each message ends, and what it is.
    pub messages: Vec<Entry>,
}

/// One message of a [`Batch`].
pub struct Entry {
    /// Index of its channel among the sink's topics.
    pub channel: usize,
    /// Its time, ns.
    pub log_time: u64,
    /// Where its bytes end in the batch.
    pub end: usize,
}

impl Batch {
    /// An empty batch with room for so many bytes.
    pub fn with_capacity(bytes: usize) -> Self {
        Self {
            bytes: Vec::with_capacity(bytes),
            messages: Vec::new(),
        }
    }

    /// Empties the batch and keeps its memory.
    pub fn clear(&mut self) {
        self.bytes.clear();
        self.messages.clear();
    }
}

/// The file of a recording.
pub struct Sink {
    path: PathBuf,
    writer: Writer<NoSeek<BufWriter<File>>>,
    channels: Vec<Channel>,
    digester: Digester,
}

struct Channel {
    id: u16,
    topic: String,
    sequence: u32,
}

impl Sink {
    /// Creates the file and writes facts, experiment, calibrations (name to text) and the channels of `topics`.
    pub fn create(
        path: &Path,
        facts: &RunFacts,
        experiment: &str,
        calibrations: &BTreeMap<String, String>,
        topics: &[Topic],
    ) -> Result<Self, RecordError> {
        facts.validate()?;
        let file = File::create(path).map_err(|source| file_error(path, source))?;
        let options = WriteOptions::new()
            .profile("ros2")
            .library(concat!("feeler ", env!("CARGO_PKG_VERSION")))
            // Noise does not compress: LZ4 took off an eighth for a third of the run's time.
            .compression(None)
            .chunk_size(None)
            .disable_seeking(true);
        let writer = options.create(NoSeek::new(BufWriter::new(file)));
        let mut sink = Self {
            path: path.to_path_buf(),
            writer: writer.map_err(|source| mcap_error(path, source))?,
            channels: Vec::new(),
            digester: Digester::default(),
        };
        let map = facts.to_map()?;
        digest_facts(&mut sink.digester, &map, experiment);
        let facts = Metadata {
            name: FACTS.into(),
            metadata: map,
        };
        (sink.writer.write_metadata(&facts))
            .and_then(|()| sink.attach(EXPERIMENT.into(), experiment))
            .and_then(|()| {
                let mut texts = calibrations.iter();
                texts.try_for_each(|(name, text)| sink.attach(format!("{CALIBRATION}{name}"), text))
            })
            .and_then(|()| sink.open_channels(topics))
            .map_err(|source| mcap_error(path, source))?;
        Ok(sink)
    }

    fn attach(&mut self, name: String, text: &str) -> Result<(), McapError> {
        self.writer.attach(&Attachment {
            log_time: 0,
            create_time: 0,
            name,
            media_type: "application/toml".into(),
            data: Cow::Borrowed(text.as_bytes()),
        })
    }

    fn open_channels(&mut self, topics: &[Topic]) -> Result<(), McapError> {
        for topic in topics {
            let (name, text) = topic.schema();
            let schema = (self.writer).add_schema(name, "ros2msg", text.as_bytes())?;
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

    /// Writes a batch as one chunk and hands it to the system.
    pub fn write(&mut self, batch: &Batch) -> Result<(), RecordError> {
        let mut start = 0;
        for entry in &batch.messages {
            let bytes = &batch.bytes[start..entry.end];
            start = entry.end;
            let channel = &mut self.channels[entry.channel];
            (self.digester).message(&channel.topic, entry.log_time, bytes);
            let header = MessageHeader {
                channel_id: channel.id,
                sequence: channel.sequence,
                log_time: entry.log_time,
                publish_time: entry.log_time,
            };
            channel.sequence = channel.sequence.wrapping_add(1);
            (self.writer.write_to_known_channel(&header, bytes))
                .map_err(|source| mcap_error(&self.path, source))?;
        }
        let flushed = self.writer.flush();
        flushed.map_err(|source| mcap_error(&self.path, source))
    }

    /// Writes wall time (s), digest and how the run ended, and closes the file.
    pub fn close(
        mut self,
        wall_time: Option<f64>,
        run_end: Option<&RunEnd>,
    ) -> Result<Digest, RecordError> {
        let digest = std::mem::take(&mut self.digester).finish();
        let mut metadata = BTreeMap::from([("digest".to_string(), digest.to_string())]);
        if let Some(seconds) = wall_time {
            metadata.insert("wall_time".into(), seconds.to_string());
        }
        if let Some(run_end) = run_end {
            run_end.write(&mut metadata);
        }
        let end = Metadata {
            name: END.into(),
            metadata,
        };
        (self.writer.write_metadata(&end))
            .and_then(|()| self.writer.finish())
            .map_err(|source| mcap_error(&self.path, source))?;
        let mut buffered = self.writer.into_inner().into_inner();
        let flushed = buffered.flush();
        flushed.map_err(|source| file_error(&self.path, source))?;
        Ok(digest)
    }
}

/// The facts that are no part of the digest: what only a simulated world knows shows in the forces, and a hand in a
/// program of its own does not know it; and what the experiment, which is taken in, says, too.
const NOT_DIGESTED: [&str; 3] = ["truth", "section", "law"];

/// Takes in the facts and the experiment, as they stand before all messages.
pub fn digest_facts(
    digester: &mut Digester,
    facts: &BTreeMap<String, String>,
    experiment_toml: &str,
) {
    for (key, value) in facts
        .iter()
        .filter(|(key, _)| !NOT_DIGESTED.contains(&key.as_str()))
    {
        digester.block(key.as_bytes());
        digester.block(value.as_bytes());
    }
    digester.block(experiment_toml.as_bytes());
}

fn file_error(path: &Path, source: std::io::Error) -> RecordError {
    RecordError::File {
        path: path.to_path_buf(),
        source,
    }
}

fn mcap_error(path: &Path, source: McapError) -> RecordError {
    RecordError::of_mcap(path, source)
}
