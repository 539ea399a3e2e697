//! Reads a recording that another tool has written anew: metadata and attachments are anywhere, channels have other numbers, and
//! messages may have another order.

use super::collector::Collector;
use super::facts::RunFacts;
use super::read::{Part, ReadSeek};
use super::recording::{PictureAt, Recording};
use super::scan::{Found, Place, scan};
use super::sink::{CALIBRATION, END, EXPERIMENT, FACTS, POLICY};
use super::topic::topics;
use ::mcap::records::{MessageHeader, Metadata, Record};
use std::collections::{BTreeMap, HashMap};

/// Topics that an error names at most.
const NAMED: usize = 8;

/// Reads the recording in `file`, which is at its beginning.
///
/// # Errors
/// If it holds no run or several, why, in words.
pub(super) fn read_rewritten(
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
            // These have been taken.
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

/// Place of each topic among those that a run writes at a control step.
fn order_of_writing(facts: Option<&RunFacts>) -> HashMap<String, usize> {
    let of_finger = |finger| {
        [
            topics::image(finger).name(),
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

/// A message that waits for its turn.
struct Held {
    /// Place of its topic in the order of writing.
    rank: usize,
    header: MessageHeader,
    place: Place,
    bytes: Vec<u8>,
}

/// Takes all messages: in file order if the run's digest matches it, else in the order in which a run writes them, by
/// time and channel.
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

/// What a file holds beside messages, and what kinds of messages it holds.
#[derive(Default)]
struct Outline {
    /// The library that wrote it.
    writer: String,
    /// The facts of each run, once if copies of one were merged.
    runs: Vec<Metadata>,
    /// Its end and attachments.
    kept: Vec<Record<'static>>,
    schemas: HashMap<u16, String>,
    topics: BTreeMap<u16, Topic>,
    /// Time of the newest message so far, ns, and whether an older one came after it.
    newest: u64,
    goes_back: bool,
    /// The first chunk of no use.
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

    /// A collector that has all of the run except its messages. `stopped` is why the scan ended early.
    fn collector(mut self, stopped: Option<String>) -> Result<Collector, String> {
        if self.runs.len() > 1 {
            return Err(format!(
                "one run expected, {} found (metadata {FACTS:?}), merged by {:?}: read them before they are merged",
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

    /// Error for a file without a run.
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
            "a run of feeler expected (metadata {FACTS:?}), {count} topics of {:?} found: {}{others}; Rerun, Foxglove and PlotJuggler show such a file",
            self.writer,
            topics.join(", ")
        )
    }
}

/// Whether an attachment of this name is one of a run.
fn is_of_run(name: &str) -> bool {
    name == EXPERIMENT || name.starts_with(CALIBRATION) || name.starts_with(POLICY)
}
