//! Reads a recording back, whole or as far as it goes.

use super::digest::Digester;
use super::error::RecordError;
use super::facts::RunFacts;
use super::options::PolicyFile;
use super::recording::{Damage, PictureAt, Recording};
use super::run_end::RunEnd;
use super::scan::{Found, scan};
use super::sink::{CALIBRATION, CHANNELS, END, EXPERIMENT, FACTS, POLICY, digest_facts};
use super::topic::Channel;
use ::mcap::records::Record;
use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

impl Recording {
    /// Reads a recording. What is readable of a damaged one is returned, with
    /// [`complete`](Self::complete) false and [`problem`](Self::problem) saying why.
    ///
    /// # Errors
    /// When the file cannot be read or not even the run's facts are in it.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, RecordError> {
        Self::read_in_parts(path, &mut |_, _| {})
    }

    /// Reads a recording of any length: after every [`PART`] messages, `part` is given what is there so far, and the
    /// share of the file that was read, 0 to 1. It may take what it needs and
    /// [let go of the rest](Self::forget_until). What is returned holds what nobody let go of; digest, end, gaps
    /// and problem are those of the whole file.
    ///
    /// # Errors
    /// As of [`read`](Self::read).
    pub fn read_in_parts(
        path: impl AsRef<Path>,
        part: &mut dyn FnMut(&mut Self, f64),
    ) -> Result<Self, RecordError> {
        let path = path.as_ref();
        let failed = |source| RecordError::File {
            path: path.to_path_buf(),
            source,
        };
        let file = File::open(path).map_err(failed)?;
        let length = file.metadata().map_err(failed)?.len().max(1);
        let mut part = |recording: &mut Self, offset: u64| {
            part(recording, (offset as f64 / length as f64).min(1.0));
        };
        Self::from_reader(&mut BufReader::new(file), &mut part).map_err(|reason| {
            RecordError::NothingReadable {
                path: path.to_path_buf(),
                reason,
            }
        })
    }

    /// Reads a recording from memory.
    ///
    /// # Errors
    /// When not even the run's facts are readable: why, in words.
    pub fn from_bytes(mut file: &[u8]) -> Result<Self, String> {
        Self::from_reader(&mut file, &mut |_, _| {})
    }

    fn from_reader(file: &mut dyn Read, part: &mut Part<'_>) -> Result<Self, String> {
        let mut collector = Collector::default();
        let scanned = scan(file, &mut |found| match found {
            Found::Record(record, offset) => {
                collector.take(record, offset)?;
                collector.hand_over(offset, part);
                Ok(())
            }
            Found::Damage(reason) => {
                collector.skip(reason);
                Ok(())
            }
        });
        collector.finish(scanned.err())
    }
}

/// Messages of a part of a recording: of half a second to some seconds.
pub const PART: usize = 2_000;

/// Is given what was read so far, and how far in the file that is, bytes from the start.
type Part<'a> = dyn FnMut(&mut Recording, u64) + 'a;

/// The text of the attachment called `name`.
fn text(name: &str, data: &[u8]) -> Result<String, String> {
    let text = std::str::from_utf8(data).map_err(|_| format!("{name} is not UTF-8 text"))?;
    Ok(text.to_string())
}

/// What stands before a message's bytes in its record: channel, sequence number and two times.
pub(super) const MESSAGE_HEAD: u64 = 2 + 4 + 8 + 8;

/// Takes the records in and makes a [`Recording`] of them.
#[derive(Default)]
struct Collector {
    recording: Option<Recording>,
    facts: BTreeMap<String, String>,
    digester: Option<Digester>,
    channels: HashMap<u16, (Channel, String)>,
    end: Option<BTreeMap<String, String>>,
    has_experiment: bool,
    /// Whether what follows is messages.
    has_begun: bool,
    /// The first chunk of no use.
    damage: Option<Damage>,
    /// Messages since a part was handed over.
    since_part: usize,
}

impl Collector {
    /// Takes a record whose body begins at `offset` in the file.
    fn take(&mut self, record: Record<'_>, offset: u64) -> Result<(), String> {
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
                self.recording()?.experiment = text(EXPERIMENT, &data)?;
                self.has_experiment = true;
            }
            Record::Attachment { header, data, .. } => {
                if let Some(name) = header.name.strip_prefix(CALIBRATION) {
                    let text = text(&header.name, &data)?;
                    self.recording()?.calibrations.insert(name.into(), text);
                } else if let Some(name) = header.name.strip_prefix(POLICY) {
                    self.recording()?.policy = Some(PolicyFile {
                        name: name.into(),
                        bytes: data[..].into(),
                    });
                }
            }
            Record::Channel(channel) => self.channel(channel.id, channel.topic)?,
            Record::Message { header, data } => {
                let at = PictureAt {
                    log_time: header.log_time,
                    offset: offset + MESSAGE_HEAD,
                    length: data.len(),
                };
                self.message(header.channel_id, &data, at)?;
            }
            _ => {}
        }
        Ok(())
    }

    /// Hands over a part, if enough has come together.
    fn hand_over(&mut self, offset: u64, part: &mut Part<'_>) {
        if self.since_part < PART {
            return;
        }
        self.since_part = 0;
        if let Some(recording) = &mut self.recording {
            part(recording, offset);
        }
    }

    /// Takes the number of the channel of `topic`, if it is one of ours.
    fn channel(&mut self, id: u16, topic: String) -> Result<(), String> {
        let mut channels = Channel::known(&self.recording()?.facts);
        if let Some(known) = channels.find(|channel| channel.topic() == topic) {
            self.channels.insert(id, (known, topic));
        }
        Ok(())
    }

    /// Goes on after a chunk that is of no use.
    fn skip(&mut self, reason: String) {
        let steps = self
            .recording
            .as_ref()
            .map_or(0, |recording| recording.steps_read());
        // Before the messages there is nothing in chunks that is not elsewhere, too.
        let steps_before = if self.has_begun { steps } else { usize::MAX };
        self.damage.get_or_insert(Damage {
            reason,
            steps_before,
        });
    }

    fn recording(&mut self) -> Result<&mut Recording, String> {
        (self.recording.as_mut()).ok_or_else(|| format!("no metadata {FACTS:?} before the data"))
    }

    fn message(&mut self, channel: u16, bytes: &[u8], at: PictureAt) -> Result<(), String> {
        let log_time = at.log_time;
        let recording = (self.recording.as_mut())
            .ok_or_else(|| format!("no metadata {FACTS:?} before the data"))?;
        let Some((known, name)) = self.channels.get(&channel) else {
            return Ok(()); // a channel of someone else's
        };
        if known.derived {
            return Ok(());
        }
        (known.read_into)(recording, known.finger, bytes, at)
            .map_err(|e| format!("message on {name}: {e}"))?;
        let digester = self.digester.get_or_insert_with(|| {
            let mut digester = Digester::default();
            digest_facts(&mut digester, &self.facts, &recording.experiment);
            digester
        });
        digester.message(name, log_time, bytes);
        self.since_part += 1;
        recording.readable_until = recording.readable_until.max(log_time as f64 * 1e-9);
        Ok(())
    }

    /// Makes the recording, given why scanning stopped early.
    fn finish(self, stopped: Option<String>) -> Result<Recording, String> {
        let damage = self.damage.as_ref().map(|damage| damage.reason.clone());
        let stopped = damage.or(stopped);
        let Some(mut recording) = self.recording else {
            return Err(stopped.unwrap_or_else(|| format!("no metadata {FACTS:?} in it")));
        };
        let digester = self.digester.unwrap_or_else(|| {
            let mut digester = Digester::default();
            digest_facts(&mut digester, &self.facts, &recording.experiment);
            digester
        });
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
            (None, Some(written)) if written != recording.digest.as_str() => Some(format!(
                "its content has digest {}, it was closed with {written}",
                recording.digest
            )),
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
