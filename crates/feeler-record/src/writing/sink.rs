//! Writes batches of encoded messages to the file, on the recorder's thread.

use super::batch::Batch;
use super::options::{PolicyFile, RecordOptions};
use super::writer::{End, Store};
use crate::error::RecordError;
use crate::messages::channels::{RecordingGap, nanoseconds};
use crate::messages::facts::RunFacts;
use crate::messages::topic::{Channel, topics};
use crate::reading::container::{Container, Output};
use crate::reading::digest::{Digest, Digester};
use crate::wire::cdr;
use ::mcap::WriteOptions;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;

/// Name of the metadata record with the run's facts, at the start of the file.
pub const FACTS: &str = "feeler.run";
/// Name of the metadata record with the topic of each channel id. It repeats the chunk of channel records, so that
/// messages remain readable if that chunk is damaged.
pub const CHANNELS: &str = "feeler.channels";
/// Name of the metadata record at the end of the file: wall time, digest, and how the run ended.
pub const END: &str = "feeler.end";
/// Name of the attachment with the experiment as run.
pub const EXPERIMENT: &str = "experiment.toml";

/// Prefix of the attachment names of calibrations; the rest is the name in the experiment.
pub const CALIBRATION: &str = "calibration/";
/// Prefix of the attachment name of a policy; the rest is the name in the experiment.
pub const POLICY: &str = "policy/";

/// Media type of the experiment and of calibrations.
const TOML: &str = "application/toml";
/// Media type of attached policy files, for which no specific type is registered.
const BYTES: &str = "application/octet-stream";

/// The file of a recording.
pub struct Sink {
    container: Container,
    digester: Digester,
    /// Index of the channel of gaps, which is registered at the first gap.
    gaps: Option<usize>,
}

impl Sink {
    /// Creates the file, writes facts, experiment and the files in `options`, and registers `channels`.
    pub fn create(
        path: &Path,
        facts: &RunFacts,
        experiment: &str,
        options: &RecordOptions,
        channels: &[Channel],
    ) -> Result<Self, RecordError> {
        facts.validate()?;
        let container = Container::create(path, unchunked())?;
        Self::in_container(container, facts, experiment, options, channels)
    }

    /// Like [`create`](Self::create), but writes the file to `output`.
    pub fn to_output(
        output: Output,
        facts: &RunFacts,
        experiment: &str,
        options: &RecordOptions,
        channels: &[Channel],
    ) -> Result<Self, RecordError> {
        facts.validate()?;
        let container = Container::to_output(output, Path::new(""), unchunked())?;
        Self::in_container(container, facts, experiment, options, channels)
    }

    fn in_container(
        mut container: Container,
        facts: &RunFacts,
        experiment: &str,
        options: &RecordOptions,
        channels: &[Channel],
    ) -> Result<Self, RecordError> {
        let mut digester = Digester::default();
        let facts = facts.to_map()?;
        digest_facts(&mut digester, &facts, experiment);
        container.metadata(FACTS, facts)?;
        container.attach(EXPERIMENT.into(), TOML, experiment.as_bytes())?;
        for (name, text) in &options.calibrations {
            container.attach(format!("{CALIBRATION}{name}"), TOML, text.as_bytes())?;
        }
        if let Some(PolicyFile { name, bytes }) = &options.policy {
            container.attach(format!("{POLICY}{name}"), BYTES, bytes)?;
        }
        container.register(channels)?;
        container.flush()?;
        container.metadata(CHANNELS, container.ids())?;
        Ok(Self {
            container,
            digester,
            gaps: None,
        })
    }

    /// Writes a gap message.
    fn write_gap(&mut self, gap: &RecordingGap) -> Result<(), RecordError> {
        let channel = match self.gaps {
            Some(channel) => channel,
            None => self.container.add(&topics::RECORDING_GAP.into())?,
        };
        self.gaps = Some(channel);
        let mut bytes = Vec::new();
        cdr::encode(gap, &mut bytes)?;
        let log_time = nanoseconds(gap.end).unwrap_or_default();
        self.write_message(channel, log_time, &bytes)
    }

    fn write_message(
        &mut self,
        channel: usize,
        log_time: u64,
        bytes: &[u8],
    ) -> Result<(), RecordError> {
        let stored = match self.container.stored(channel) {
            Some(make) => Cow::Owned(make(bytes)?),
            None => Cow::Borrowed(bytes),
        };
        if !self.container.is_derived(channel) {
            let topic = self.container.topic(channel);
            self.digester.message(topic, log_time, &stored);
        }
        self.container.write(channel, log_time, &stored)
    }
}

impl Store for Sink {
    /// Writes a batch as one chunk and passes it to the operating system.
    fn write(&mut self, batch: &Batch) -> Result<(), RecordError> {
        if let Some(gap) = &batch.gap {
            self.write_gap(gap)?;
        }
        let mut start = 0;
        for entry in &batch.messages {
            let bytes = &batch.bytes[start..entry.end];
            start = entry.end;
            self.write_message(entry.channel, entry.log_time, bytes)?;
        }
        self.container.flush()
    }

    /// Writes wall time (s), digest, how the run ended and the number of dropped messages, and closes the file.
    fn close(mut self, at: &End) -> Result<Digest, RecordError> {
        let digest = self.digester.finish();
        let mut end = BTreeMap::from([("digest".to_string(), digest.to_string())]);
        if let Some(seconds) = at.wall_time {
            end.insert("wall_time".into(), seconds.to_string());
        }
        if let Some(run_end) = &at.run_end {
            run_end.write(&mut end);
        }
        if at.dropped > 0 {
            end.insert("dropped".into(), at.dropped.to_string());
        }
        self.container.metadata(END, end)?;
        self.container.close()?;
        Ok(digest)
    }
}

/// Write options without automatic chunks: each batch becomes one chunk.
fn unchunked() -> WriteOptions {
    WriteOptions::new().chunk_size(None)
}

/// Facts that are not part of the digest. Ground truth affects the forces and is not available to a hand in a separate
/// program; goal, law and hand follow from the experiment, which is part of the digest.
const NOT_DIGESTED: [&str; 6] = ["truth", "section", "solids", "carry", "law", "hand"];

/// Appends the facts and the experiment, which precede all messages, to a digest.
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
