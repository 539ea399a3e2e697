//! Builds a recording from the records of its file.

use super::digest::Digester;
use super::part::{PART, Part};
use super::recording::{Damage, PictureAt, Recording};
use super::scan::{Found, Place};
use crate::messages::facts::RunFacts;
use crate::messages::run_end::RunEnd;
use crate::messages::topic::Channel;
use crate::writing::options::PolicyFile;
use crate::writing::sink::{CALIBRATION, CHANNELS, END, EXPERIMENT, FACTS, POLICY, digest_facts};
use ::mcap::records::Record;
use std::collections::{BTreeMap, HashMap};

/// Converts the attachment `name` to text.
fn text(name: &str, data: &[u8]) -> Result<String, String> {
    let text = std::str::from_utf8(data).map_err(|_| format!("{name} is not UTF-8 text"))?;
    Ok(text.to_string())
}

/// Returns the recording, or an error if the run's facts have not been read yet.
fn begun(recording: &mut Option<Recording>) -> Result<&mut Recording, String> {
    let recording = recording.as_mut();
    recording.ok_or_else(|| format!("no metadata {FACTS:?} before the data"))
}

/// Starts the digest of a recording with its facts and experiment.
fn begin(facts: &BTreeMap<String, String>, recording: &Recording) -> Digester {
    let mut digester = Digester::default();
    digest_facts(&mut digester, facts, &recording.experiment);
    digester
}

/// Collects records into a [`Recording`].
#[derive(Default)]
pub(crate) struct Collector {
    recording: Option<Recording>,
    facts: BTreeMap<String, String>,
    digester: Option<Digester>,
    channels: HashMap<u16, (Channel, String)>,
    end: Option<BTreeMap<String, String>>,
    has_experiment: bool,
    /// `true` once the header (channels, attachments, facts) is complete and only messages follow.
    has_begun: bool,
    /// First damaged chunk.
    damage: Option<Damage>,
    /// Number of messages since the last part was passed on.
    since_part: usize,
    /// Library that rewrote the file, if any.
    rewritten_by: Option<String>,
}

impl Collector {
    /// Creates a collector for a file rewritten by `writer`, whose chunks may also contain channels.
    pub fn of_rewritten(writer: String) -> Self {
        Self {
            has_begun: true,
            rewritten_by: Some(writer),
            ..Self::default()
        }
    }

    /// Collects `found`, and passes on a part if it is large enough.
    pub fn find(&mut self, found: Found<'_>, part: &mut Part<'_>) -> Result<(), String> {
        match found {
            Found::Record(record, place) => {
                self.take(record, place)?;
                self.hand_over(place.in_file(), part);
            }
            Found::Damage(reason) => self.skip(reason),
        }
        Ok(())
    }

    /// Collects a record whose body begins at `place`.
    pub fn take(&mut self, record: Record<'_>, place: Place) -> Result<(), String> {
        match record {
            Record::Metadata(m) if m.name == FACTS && self.recording.is_none() => {
                self.recording = Some(Recording::empty(RunFacts::from_map(&m.metadata)?));
                self.facts = m.metadata;
            }
            Record::Metadata(m) if m.name == CHANNELS => {
                for (id, topic) in m.metadata {
                    let id = id
                        .parse()
                        .map_err(|_| format!("{CHANNELS}: number {id:?}"))?;
                    self.channel(id, topic)?;
                }
                self.has_begun = true;
            }
            Record::Metadata(m) if m.name == END => self.end = Some(m.metadata),
            Record::Attachment { header, data, .. } if header.name == EXPERIMENT => {
                begun(&mut self.recording)?.experiment = text(EXPERIMENT, &data)?;
                self.has_experiment = true;
            }
            Record::Attachment { header, data, .. } => {
                if let Some(name) = header.name.strip_prefix(CALIBRATION) {
                    let text = text(&header.name, &data)?;
                    begun(&mut self.recording)?
                        .calibrations
                        .insert(name.into(), text);
                } else if let Some(name) = header.name.strip_prefix(POLICY) {
                    begun(&mut self.recording)?.policy = Some(PolicyFile {
                        name: name.into(),
                        bytes: data[..].into(),
                    });
                }
            }
            Record::Channel(channel) => self.channel(channel.id, channel.topic)?,
            Record::Message { header, data } => {
                let at = PictureAt::new(header.log_time, place, data.len());
                self.message(header.channel_id, &data, at)?;
            }
            _ => {}
        }
        Ok(())
    }

    /// Passes on a part if it is large enough.
    pub fn hand_over(&mut self, offset: u64, part: &mut Part<'_>) {
        if self.since_part < PART {
            return;
        }
        self.since_part = 0;
        if let Some(recording) = &mut self.recording {
            part(recording, offset);
        }
    }

    /// Registers the id of the channel of `topic`, if the topic is known.
    pub fn channel(&mut self, id: u16, topic: String) -> Result<(), String> {
        let mut channels = Channel::known(&begun(&mut self.recording)?.facts);
        if let Some(known) = channels.find(|channel| channel.topic() == topic) {
            self.channels.insert(id, (known, topic));
        }
        Ok(())
    }

    /// Records a damaged chunk, after which reading continues.
    pub fn skip(&mut self, reason: String) {
        let recording = self.recording.as_ref();
        let steps = recording.map_or(0, Recording::steps_read);
        // Before the messages, chunks only repeat information.
        let steps_before = if self.has_begun { steps } else { usize::MAX };
        self.damage.get_or_insert(Damage {
            reason,
            steps_before,
        });
    }

    pub fn message(&mut self, channel: u16, bytes: &[u8], at: PictureAt) -> Result<(), String> {
        let log_time = at.log_time;
        let recording = begun(&mut self.recording)?;
        let Some((known, name)) = self.channels.get(&channel) else {
            return Ok(()); // an unknown channel
        };
        (known.read_into)(recording, known.finger, bytes, at)
            .map_err(|e| format!("message on {name}: {e}"))?;
        if known.derived {
            return Ok(());
        }
        let digester = self
            .digester
            .get_or_insert_with(|| begin(&self.facts, recording));
        digester.message(name, log_time, bytes);
        self.since_part += 1;
        recording.readable_until = recording.readable_until.max(log_time as f64 * 1e-9);
        Ok(())
    }

    /// Digest before the first message.
    pub fn digester(&self) -> Digester {
        let recording = self.recording.as_ref();
        recording.map_or_else(Digester::default, |recording| begin(&self.facts, recording))
    }

    /// Digest written at the end of the run, if any.
    pub fn closed_with(&self) -> Option<&str> {
        self.end.as_ref()?.get("digest").map(String::as_str)
    }

    /// Topic of a channel, if known.
    pub fn topic(&self, channel: u16) -> Option<&str> {
        let (_, topic) = self.channels.get(&channel)?;
        Some(topic)
    }

    /// Facts of the run, if already collected.
    pub fn facts(&self) -> Option<&RunFacts> {
        self.recording.as_ref().map(|recording| &recording.facts)
    }

    /// Completes the recording. `stopped` is the reason if the scan ended early.
    pub fn finish(self, stopped: Option<String>) -> Result<Recording, String> {
        let damage = self.damage.as_ref().map(|damage| damage.reason.clone());
        let stopped = damage.or(stopped);
        let Some(mut recording) = self.recording else {
            return Err(stopped.unwrap_or_else(|| format!("no metadata {FACTS:?} in it")));
        };
        let digester = self.digester;
        let digester = digester.unwrap_or_else(|| begin(&self.facts, &recording));
        recording.digest = digester.finish();
        recording.wall_time = (self.end.as_ref())
            .and_then(|end| end.get("wall_time")?.parse().ok())
            .filter(|seconds: &f64| seconds.is_finite());
        let written = self.end.as_ref().and_then(|end| end.get("digest"));
        recording.damage = self.damage;
        recording.problem = match (stopped, written) {
            (Some(reason), _) => Some(reason),
            (None, _) if !self.has_experiment => Some(format!("no attachment {EXPERIMENT:?}")),
            (None, None) => Some("the run was not closed".into()),
            (None, Some(written)) if written != recording.digest.as_str() => {
                let rewritten = self.rewritten_by.map_or_else(String::new, |writer| {
                    format!(": {writer:?} rewrote it and omitted or changed messages")
                });
                Some(format!(
                    "the digest of its content is {}, but it was closed with {written}{rewritten}",
                    recording.digest
                ))
            }
            (None, Some(_)) => None,
        };
        let problem = recording.problem.as_deref();
        recording.end = RunEnd::of(problem, recording.task.last(), self.end.as_ref());
        if let (None, Some(missing)) = (problem, recording.missing()) {
            recording.end = recording.end.with_gap(&missing);
            recording.problem = Some(missing);
        }
        recording.complete = recording.problem.is_none();
        Ok(recording)
    }
}
