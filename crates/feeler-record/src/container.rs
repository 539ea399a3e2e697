//! An MCAP file of ROS 2 messages that is being written: channels are registered, then written to.

use super::channels::{Stamped, nanoseconds};
use super::error::RecordError;
use super::topic::{Channel, Conversion, RecordedTopic};
use ::mcap::records::{MessageHeader, Metadata};
use ::mcap::write::NoSeek;
use ::mcap::{Attachment, McapError, WriteOptions, Writer};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};

/// What the name of the library that wrote a file begins with: ours.
pub(super) const LIBRARY: &str = "feeler ";

/// How rosbag2 learns how a channel is to be published, and what it is to do with one whose messages hold from then on:
/// keep the last for whoever comes later.
const QOS: &str = "offered_qos_profiles";
const LATCHED: &str = "\
- history: keep_last
  depth: 1
  reliability: reliable
  durability: transient_local
  deadline: {sec: 0, nsec: 0}
  lifespan: {sec: 0, nsec: 0}
  liveliness: automatic
  liveliness_lease_duration: {sec: 0, nsec: 0}
  avoid_ros_namespace_conventions: false
";

/// The file and its channels.
pub struct Container {
    path: PathBuf,
    writer: Writer<NoSeek<BufWriter<File>>>,
    channels: Vec<OpenChannel>,
}

struct OpenChannel {
    id: u16,
    topic: String,
    sequence: u32,
    derived: bool,
    stored: Option<Conversion>,
}

impl Container {
    /// Creates the file; `options` may say how chunks are made.
    pub fn create(path: &Path, options: WriteOptions) -> Result<Self, RecordError> {
        let file = File::create(path).map_err(|source| file_error(path, source))?;
        let writer = options
            .profile("ros2")
            .library(format!("{LIBRARY}{}", env!("CARGO_PKG_VERSION")))
            // Noise does not compress: LZ4 took off an eighth for a third of the run's time.
            .compression(None)
            .disable_seeking(true)
            .create(NoSeek::new(BufWriter::new(file)))
            .map_err(|source| RecordError::of_mcap(path, source))?;
        Ok(Self {
            path: path.to_path_buf(),
            writer,
            channels: Vec::new(),
        })
    }

    /// Registers channels, which are numbered in the order of their registration, from 0.
    pub fn register(&mut self, channels: &[Channel]) -> Result<(), RecordError> {
        for channel in channels {
            self.add(channel)?;
        }
        Ok(())
    }

    /// Registers one channel more; its number.
    pub fn add(&mut self, channel: &Channel) -> Result<usize, RecordError> {
        let open = self.open(channel);
        let open = open.map_err(|source| self.failed(source))?;
        self.channels.push(open);
        Ok(self.channels.len() - 1)
    }

    fn open(&mut self, channel: &Channel) -> Result<OpenChannel, McapError> {
        let (name, text) = channel.schema;
        let schema = (self.writer).add_schema(name, "ros2msg", text.as_bytes())?;
        let topic = channel.topic();
        let latched = channel
            .is_latched()
            .then(|| (QOS.to_string(), LATCHED.to_string()));
        let metadata = latched.into_iter().collect();
        let id = (self.writer).add_channel(schema, &topic, "cdr", &metadata)?;
        Ok(OpenChannel {
            id,
            topic,
            sequence: 0,
            derived: channel.derived,
            stored: channel.stored,
        })
    }

    /// Name of the topic of a registered channel.
    pub fn topic(&self, channel: usize) -> &str {
        &self.channels[channel].topic
    }

    /// Whether the messages of a registered channel follow from others.
    pub fn is_derived(&self, channel: usize) -> bool {
        self.channels[channel].derived
    }

    /// What makes of an encoded message of a registered channel the bytes that are written, if those are others.
    pub fn stored(&self, channel: usize) -> Option<Conversion> {
        self.channels[channel].stored
    }

    /// The topics of all registered channels, by the number of the channel in the file.
    pub fn ids(&self) -> BTreeMap<String, String> {
        let channels = self.channels.iter();
        let ids = channels.map(|channel| (channel.id.to_string(), channel.topic.clone()));
        ids.collect()
    }

    /// Writes an encoded message of time `log_time`, ns, to a registered channel.
    pub fn write(
        &mut self,
        channel: usize,
        log_time: u64,
        bytes: &[u8],
    ) -> Result<(), RecordError> {
        let channel = &mut self.channels[channel];
        let header = MessageHeader {
            channel_id: channel.id,
            sequence: channel.sequence,
            log_time,
            publish_time: log_time,
        };
        channel.sequence = channel.sequence.wrapping_add(1);
        let written = self.writer.write_to_known_channel(&header, bytes);
        written.map_err(|source| self.failed(source))
    }

    /// Writes texts by name.
    pub fn metadata(
        &mut self,
        name: &str,
        metadata: BTreeMap<String, String>,
    ) -> Result<(), RecordError> {
        let name = name.into();
        let written = self.writer.write_metadata(&Metadata { name, metadata });
        written.map_err(|source| self.failed(source))
    }

    /// Attaches a file.
    pub fn attach(
        &mut self,
        name: String,
        media_type: &str,
        bytes: &[u8],
    ) -> Result<(), RecordError> {
        let written = self.writer.attach(&Attachment {
            log_time: 0,
            create_time: 0,
            name,
            media_type: media_type.into(),
            data: Cow::Borrowed(bytes),
        });
        written.map_err(|source| self.failed(source))
    }

    /// Ends the chunk and hands it to the system.
    pub fn flush(&mut self) -> Result<(), RecordError> {
        let flushed = self.writer.flush();
        flushed.map_err(|source| self.failed(source))
    }

    /// Writes the end of the file and closes it.
    pub fn close(mut self) -> Result<(), RecordError> {
        let finished = self.writer.finish();
        finished.map_err(|source| self.failed(source))?;
        let flushed = self.writer.into_inner().into_inner().flush();
        flushed.map_err(|source| file_error(&self.path, source))
    }

    fn failed(&self, source: McapError) -> RecordError {
        RecordError::of_mcap(&self.path, source)
    }
}

/// Place of a topic's channel among those that were registered.
///
/// # Errors
/// When the rig of `fingers` fingers has no such finger, or the topic was not registered.
pub fn find<M>(
    channels: &[Channel],
    fingers: usize,
    topic: RecordedTopic<M>,
) -> Result<usize, RecordError> {
    topic.check_finger(fingers)?;
    let place = channels.iter().position(|channel| channel.is_of(topic));
    place.ok_or_else(|| RecordError::NotRegistered {
        topic: topic.name(),
    })
}

/// Time of a message in whole nanoseconds.
///
/// # Errors
/// When its stamp is no time of a run.
pub fn log_time<M: Stamped>(topic: RecordedTopic<M>, message: &M) -> Result<u64, RecordError> {
    let stamp = message.stamp();
    nanoseconds(stamp).ok_or_else(|| RecordError::Stamp {
        topic: topic.name(),
        stamp,
    })
}

fn file_error(path: &Path, source: std::io::Error) -> RecordError {
    RecordError::File {
        path: path.to_path_buf(),
        source,
    }
}
