//! Writer of an MCAP file with ROS 2 messages.

use crate::error::RecordError;
use crate::messages::channels::{Stamped, nanoseconds};
use crate::messages::recorded::Conversion;
use crate::messages::topic::{Channel, RecordedTopic};
use ::mcap::records::{MessageHeader, Metadata};
use ::mcap::write::NoSeek;
use ::mcap::{Attachment, McapError, WriteOptions, Writer};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// Start of the library name in files written by feeler.
pub(crate) const LIBRARY: &str = "feeler ";

/// Metadata key from which rosbag2 reads how to publish a channel, and its value for latched channels: keep the last
/// message for late subscribers.
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

/// Destination of the bytes of an MCAP file.
pub type Output = Box<dyn Write + Send>;

/// An MCAP file and its channels.
pub struct Container {
    path: PathBuf,
    writer: Writer<NoSeek<Output>>,
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
    /// Creates the file. `options` controls how chunks are made.
    pub fn create(path: &Path, options: WriteOptions) -> Result<Self, RecordError> {
        let file = File::create(path).map_err(RecordError::file(path))?;
        Self::to_output(Box::new(BufWriter::new(file)), path, options)
    }

    /// Writes an MCAP file to `output`, which errors call `path`.
    pub fn to_output(
        output: Output,
        path: &Path,
        options: WriteOptions,
    ) -> Result<Self, RecordError> {
        let writer = options
            .profile("ros2")
            .library(format!("{LIBRARY}{}", env!("CARGO_PKG_VERSION")))
            // Sensor noise does not compress: LZ4 saved an eighth of the size for a third of the run's time.
            .compression(None)
            .disable_seeking(true)
            .create(NoSeek::new(output))
            .map_err(|source| RecordError::of_mcap(path, source))?;
        Ok(Self {
            path: path.to_path_buf(),
            writer,
            channels: Vec::new(),
        })
    }

    /// Registers channels. They are numbered from 0 in order of registration.
    pub fn register(&mut self, channels: &[Channel]) -> Result<(), RecordError> {
        for channel in channels {
            self.add(channel)?;
        }
        Ok(())
    }

    /// Registers one more channel and returns its number.
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

    /// Topic of a registered channel.
    pub fn topic(&self, channel: usize) -> &str {
        &self.channels[channel].topic
    }

    /// Returns `true` if the messages of a registered channel are derived from other messages.
    pub fn is_derived(&self, channel: usize) -> bool {
        self.channels[channel].derived
    }

    /// Conversion of a registered channel's encoded messages to the bytes that are written, if they differ.
    pub fn stored(&self, channel: usize) -> Option<Conversion> {
        self.channels[channel].stored
    }

    /// Topics of all registered channels by their id in the file.
    pub fn ids(&self) -> BTreeMap<String, String> {
        let channels = self.channels.iter();
        let ids = channels.map(|channel| (channel.id.to_string(), channel.topic.clone()));
        ids.collect()
    }

    /// Writes an encoded message with time `log_time` (ns) to a registered channel.
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

    /// Writes a metadata record.
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

    /// Ends the chunk and passes it to the operating system.
    pub fn flush(&mut self) -> Result<(), RecordError> {
        let flushed = self.writer.flush();
        flushed.map_err(|source| self.failed(source))
    }

    /// Writes the end of the file and closes it.
    pub fn close(mut self) -> Result<(), RecordError> {
        let finished = self.writer.finish();
        finished.map_err(|source| self.failed(source))?;
        let flushed = self.writer.into_inner().into_inner().flush();
        flushed.map_err(RecordError::file(&self.path))
    }

    fn failed(&self, source: McapError) -> RecordError {
        RecordError::of_mcap(&self.path, source)
    }
}

/// Index of a topic's channel among `channels`.
///
/// # Errors
/// If a rig of `fingers` fingers has no such finger, or the topic was not registered.
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
/// If the stamp is not a valid time of a run.
pub fn log_time<M: Stamped>(topic: RecordedTopic<M>, message: &M) -> Result<u64, RecordError> {
    let stamp = message.stamp();
    nanoseconds(stamp).ok_or_else(|| RecordError::Stamp {
        topic: topic.name(),
        stamp,
    })
}
