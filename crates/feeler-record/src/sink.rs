//! Puts batches of encoded messages into the file; works on the recorder's own thread.

use super::batch::Batch;
use super::channels::{RecordingGap, nanoseconds};
use super::container::Container;
use super::digest::{Digest, Digester};
use super::error::RecordError;
use super::facts::RunFacts;
use super::options::{PolicyFile, RecordOptions};
use super::topic::{Channel, topics};
use super::writer::{End, Store};
use crate::wire::cdr;
use ::mcap::WriteOptions;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;

/// Name of the metadata record that holds the run's facts, at the file's start.
pub const FACTS: &str = "feeler.run";
/// Name of the metadata record that holds each channel's topic by its number, behind the chunk that says the same in
/// MCAP's way: should that be damaged, the others can be read.
pub const CHANNELS: &str = "feeler.channels";
/// Name of the metadata record at the file's end: wall time, digest, and how the run ended.
pub const END: &str = "feeler.end";
/// Name of the attachment that holds the experiment as run.
pub const EXPERIMENT: &str = "experiment.toml";

/// What stands before the experiment's name of a calibration in the name of its attachment.
pub const CALIBRATION: &str = "calibration/";
/// The same of a policy.
pub const POLICY: &str = "policy/";

/// Media type of experiment and calibrations.
const TOML: &str = "application/toml";
/// Media type of a policy, for which none is registered.
const BYTES: &str = "application/octet-stream";

/// The file of a recording.
pub struct Sink {
    container: Container,
    digester: Digester,
    /// Number of the channel of gaps, once there was one: a recording without gaps has no such channel.
    gaps: Option<usize>,
}

impl Sink {
    /// Creates the file, writes facts, experiment and the files of `options` that it names, and registers `channels`.
    pub fn create(
        path: &Path,
        facts: &RunFacts,
        experiment: &str,
        options: &RecordOptions,
        channels: &[Channel],
    ) -> Result<Self, RecordError> {
        facts.validate()?;
        let mut digester = Digester::default();
        let facts = facts.to_map()?;
        digest_facts(&mut digester, &facts, experiment);
        // A chunk ends with its batch.
        let unchunked = WriteOptions::new().chunk_size(None);
        let mut container = Container::create(path, unchunked)?;
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

    /// Writes what is missing.
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
    /// Writes a batch as one chunk and hands it to the system.
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

    /// Writes wall time (s), digest, how the run ended and how much is missing, and closes the file.
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

/// The facts that are no part of the digest: what only a simulated world knows shows in the forces, and a hand in a
/// program of its own does not know it; goal, law and hand follow from the experiment, which is taken in, too.
const NOT_DIGESTED: [&str; 6] = ["truth", "section", "solids", "carry", "law", "hand"];

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
