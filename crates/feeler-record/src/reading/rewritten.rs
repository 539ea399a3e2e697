//! Reads recordings that another tool has rewritten: metadata and attachments may be anywhere, channels may have other
//! ids, and messages may be in another order.

use super::collector::Collector;
use super::part::Part;
use super::recording::{PictureAt, Recording};
use super::scan::{Found, Place, scan};
use crate::messages::facts::RunFacts;
use crate::messages::topic::topics;
use crate::writing::sink::{CALIBRATION, END, EXPERIMENT, FACTS, POLICY};
use ::mcap::records::{MessageHeader, Metadata, Record};
use std::collections::{BTreeMap, HashMap};
use std::io::{Read, Seek};

/// A readable and seekable file.
pub(crate) trait ReadSeek: Read + Seek {}

impl<F: Read + Seek> ReadSeek for F {}

/// Maximum number of topics named in an error.
const NAMED: usize = 8;

/// Reads the recording in `file`, which must be positioned at its start.
///
/// # Errors
/// If the file contains no run or several runs. Returns a description.
pub(crate) fn read_rewritten(
    file: &mut dyn ReadSeek,
    part: &mut Part<'_>,
) -> Result<Recording, String> {
    let mut outline = Outline::default();
    let scanned = scan(file, &mut |found| outline.take(found));
    let in_order = !outline.goes_back;
    let mut collector = outline.collector(scanned.err())?;
    file.rewind().map_err(|e| e.to_string())?;
    if in_order {
        let scanned = scan(file, &mut |found| match found {
            // Already collected by the outline.
            Found::Record(Record::Metadata(_) | Record::Attachment { .. }, _) => Ok(()),
            found => collector.find(found, part),
        });
        return collector.finish(scanned.err());
    }
    let order = order_of_writing(collector.facts());
    let mut messages = Vec::new();
    let scanned = scan(file, &mut |found| match found {
        Found::Record(Record::Message { header, data }, place) => {
            let topic = collector.topic(header.channel_id);
            if let Some(&rank) = topic.and_then(|topic| order.get(topic)) {
                let bytes = data.into_owned();
                messages.push(Held {
                    rank,
                    header,
                    place,
                    bytes,
                });
            }
            Ok(())
        }
        Found::Record(Record::Channel(channel), _) => collector.channel(channel.id, channel.topic),
        Found::Record(..) => Ok(()),
        Found::Damage(reason) => {
            collector.skip(reason);
            Ok(())
        }
    });
    let stopped = take_all(&mut collector, messages, part).err();
    collector.finish(stopped.or(scanned.err()))
}

/// Rank of each topic in the order in which a run writes them at a control step.
fn order_of_writing(facts: Option<&RunFacts>) -> HashMap<String, usize> {
    let of_finger = |finger| {
        [
            topics::image(finger).name(),
            topics::samples(finger).name(),
            topics::tactile(finger).name(),
            topics::flags(finger).name(),
            topics::joints(finger).name(),
            topics::command(finger).name(),
            topics::fingertip(finger).name(),
        ]
    };
    let before = [topics::RECORDING_GAP.name(), topics::OBJECT.name()];
    let fingers = 0..facts.map_or(0, |facts| facts.fingers);
    let after = [
        topics::TORQUE_SENSOR.name(),
        topics::CAP.name(),
        topics::TRUE_SLIP.name(),
        topics::FINDINGS.name(),
        topics::TASK.name(),
    ];
    let topics = before.into_iter().chain(fingers.flat_map(of_finger));
    let topics = topics.chain(after).enumerate();
    topics.map(|(rank, topic)| (topic, rank)).collect()
}

/// A message and its sort key.
struct Held {
    /// Rank of its topic in the order of writing.
    rank: usize,
    header: MessageHeader,
    place: Place,
    bytes: Vec<u8>,
}

/// Collects all messages: in file order if that matches the run's digest, otherwise sorted by time and topic into the
/// order in which a run writes them.
fn take_all(
    collector: &mut Collector,
    mut messages: Vec<Held>,
    part: &mut Part<'_>,
) -> Result<(), String> {
    let mut digester = collector.digester();
    for message in &messages {
        let topic = collector.topic(message.header.channel_id).unwrap_or("");
        digester.message(topic, message.header.log_time, &message.bytes);
    }
    if collector.closed_with() != Some(digester.finish().as_str()) {
        messages.sort_by_key(|m| (m.header.log_time, m.rank, m.header.sequence));
    }
    for Held {
        header,
        place,
        bytes,
        ..
    } in messages
    {
        let at = PictureAt::new(header.log_time, place, bytes.len());
        collector.message(header.channel_id, &bytes, at)?;
        collector.hand_over(place.in_file(), part);
    }
    Ok(())
}

/// Metadata and topics of a file, without its messages.
#[derive(Default)]
struct Outline {
    /// Library that wrote the file.
    writer: String,
    /// Distinct facts records, one per run.
    runs: Vec<Metadata>,
    /// End record and attachments of the run.
    kept: Vec<Record<'static>>,
    schemas: HashMap<u16, String>,
    topics: BTreeMap<u16, Topic>,
    /// Latest time of a message so far (ns).
    newest: u64,
    /// `true` if any message is older than one before it.
    goes_back: bool,
    /// Description of the first damaged chunk.
    damage: Option<String>,
}

struct Topic {
    name: String,
    schema: u16,
    messages: u64,
}

impl Outline {
    fn take(&mut self, found: Found<'_>) -> Result<(), String> {
        let record = match found {
            Found::Record(record, _) => record,
            Found::Damage(reason) => {
                self.damage.get_or_insert(reason);
                return Ok(());
            }
        };
        match record {
            Record::Header(header) => self.writer = header.library,
            Record::Metadata(m) if m.name == FACTS && !self.runs.contains(&m) => self.runs.push(m),
            Record::Metadata(m) if m.name == END => self.kept.push(Record::Metadata(m)),
            Record::Attachment { header, data, crc } if is_of_run(&header.name) => {
                let data = data.into_owned().into();
                self.kept.push(Record::Attachment { header, data, crc });
            }
            Record::Schema { header, .. } => {
                self.schemas.insert(header.id, header.name);
            }
            Record::Channel(channel) => {
                self.topics.entry(channel.id).or_insert(Topic {
                    name: channel.topic,
                    schema: channel.schema_id,
                    messages: 0,
                });
            }
            Record::Message { header, .. } => {
                if let Some(topic) = self.topics.get_mut(&header.channel_id) {
                    topic.messages += 1;
                }
                self.goes_back |= header.log_time < self.newest;
                self.newest = self.newest.max(header.log_time);
            }
            _ => {}
        }
        Ok(())
    }

    /// Creates a collector that has everything except the messages. `stopped` is the reason if the scan ended early.
    fn collector(mut self, stopped: Option<String>) -> Result<Collector, String> {
        if self.runs.len() > 1 {
            return Err(format!(
                "expected one run (metadata {FACTS:?}), got {} merged by {:?}; read the recordings before merging them",
                self.runs.len(),
                self.writer
            ));
        }
        let Some(facts) = self.runs.pop() else {
            return Err(self.no_run(stopped));
        };
        let mut collector = Collector::of_rewritten(self.writer);
        collector.take(Record::Metadata(facts), Place::default())?;
        for record in self.kept {
            collector.take(record, Place::default())?;
        }
        Ok(collector)
    }

    /// Error message for a file without a run.
    fn no_run(&self, stopped: Option<String>) -> String {
        let count = self.topics.len();
        if count == 0 {
            let damage = self.damage.clone().or(stopped);
            return damage.unwrap_or_else(|| format!("no metadata {FACTS:?} in it"));
        }
        let describe = |topic: &Topic| {
            let schema = self.schemas.get(&topic.schema).map_or("", String::as_str);
            format!("{} ({schema}, {} messages)", topic.name, topic.messages)
        };
        let topics: Vec<_> = self.topics.values().take(NAMED).map(describe).collect();
        let others = count.saturating_sub(topics.len());
        let others = match others {
            0 => String::new(),
            others => format!(" and {others} more"),
        };
        format!(
            "expected a run of feeler (metadata {FACTS:?}), got {count} topics written by {:?}: {}{others}; use Rerun, Foxglove or PlotJuggler to view such a file",
            self.writer,
            topics.join(", ")
        )
    }
}

/// Returns `true` if an attachment of this name belongs to a run.
fn is_of_run(name: &str) -> bool {
    name == EXPERIMENT || name.starts_with(CALIBRATION) || name.starts_with(POLICY)
}
