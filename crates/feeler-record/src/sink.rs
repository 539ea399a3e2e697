//! Puts batches of encoded messages into the file; works on the recorder's own thread.

use super::container::Container;
use super::digest::{Digest, Digester};
use super::error::RecordError;
use super::facts::RunFacts;
use super::run_end::RunEnd;
use super::topic::Channel;
use ::mcap::WriteOptions;
use std::collections::BTreeMap;
use std::path::Path;

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
    /// Index of its channel among those registered.
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
    container: Container,
    digester: Digester,
}

impl Sink {
    /// Creates the file, writes facts, experiment and calibrations (name to text), and registers `channels`.
    pub fn create(
        path: &Path,
        facts: &RunFacts,
        experiment: &str,
        calibrations: &BTreeMap<String, String>,
        channels: &[Channel],
    ) -> Result<Self, RecordError> {
        facts.validate()?;
        let mut digester = Digester::default();
        let facts = facts.to_map()?;
        digest_facts(&mut digester, &facts, experiment);
        // A chunk ends with its batch.
        let options = WriteOptions::new().chunk_size(None);
        let mut container = Container::create(path, options)?;
        container.metadata(FACTS, facts)?;
        container.attach(EXPERIMENT.into(), experiment)?;
        for (name, text) in calibrations {
            container.attach(format!("{CALIBRATION}{name}"), text)?;
        }
        container.register(channels)?;
        container.flush()?;
        Ok(Self {
            container,
            digester,
        })
    }

    /// Writes a batch as one chunk and hands it to the system.
    pub fn write(&mut self, batch: &Batch) -> Result<(), RecordError> {
        let mut start = 0;
        for entry in &batch.messages {
            let bytes = &batch.bytes[start..entry.end];
            start = entry.end;
            let topic = self.container.topic(entry.channel);
            self.digester.message(topic, entry.log_time, bytes);
            (self.container).write(entry.channel, entry.log_time, bytes)?;
        }
        self.container.flush()
    }

    /// Writes wall time (s), digest and how the run ended, and closes the file.
    pub fn close(
        mut self,
        wall_time: Option<f64>,
        run_end: Option<&RunEnd>,
    ) -> Result<Digest, RecordError> {
        let digest = self.digester.finish();
        let mut end = BTreeMap::from([("digest".to_string(), digest.to_string())]);
        if let Some(seconds) = wall_time {
            end.insert("wall_time".into(), seconds.to_string());
        }
        if let Some(run_end) = run_end {
            run_end.write(&mut end);
        }
        self.container.metadata(END, end)?;
        self.container.close()?;
        Ok(digest)
    }
}

/// The facts that are no part of the digest: what only a simulated world knows shows in the forces, and a hand in a
/// program of its own does not know it; goal and law follow from the experiment, which is taken in, too.
const NOT_DIGESTED: [&str; 4] = ["truth", "section", "carry", "law"];

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
