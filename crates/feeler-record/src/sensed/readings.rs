//! Recordings of one sensor without a run: one MCAP file of ROS 2 messages.

use crate::error::RecordError;
use crate::messages::channels::{Moments, Tactile};
use crate::messages::contact::Contact;
use crate::messages::recorded::RecordedMessage;
use crate::messages::topic::{Channel, RecordedTopic, topics};
use crate::reading::container::{Container, find, log_time};
use crate::reading::scan::{Found, scan};
use crate::ros::WrenchStamped;
use crate::wire::cdr;
use crate::writing::memory::MessageSink;
use ::mcap::WriteOptions;
use ::mcap::records::Record;
use std::collections::HashSet;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// Moments of images, before calibration.
pub const MOMENTS: RecordedTopic<Moments> = RecordedTopic::of_rig("moments");
/// Tactile frames of the fingertip.
pub const TACTILE: RecordedTopic<Tactile> = RecordedTopic::of_rig("tactile");
/// Wrench on the fingertip, from all its elements.
pub const WRENCH: RecordedTopic<WrenchStamped> = RecordedTopic::of_rig("wrench");

/// Contact of the fingertip with an object.
pub const CONTACT: RecordedTopic<Contact> = RecordedTopic::of_rig("contact");

/// Writes [`Moments`] to [`MOMENTS`] and either [`Tactile`] frames to [`TACTILE`] or [`WrenchStamped`] to [`WRENCH`].
/// Images are optional and written to [`topics::image`], as in recordings of runs.
///
/// Until [`finish`](Self::finish) is called, the file has no end record, which MCAP readers report.
pub struct SensedWriter {
    container: Container,
    channels: Vec<Channel>,
    /// Number of fingers for which messages may be written.
    fingers: usize,
    buffer: Vec<u8>,
}

impl SensedWriter {
    /// Creates a file for tactile frames, and for images of `finger` if given.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn create(path: impl AsRef<Path>, finger: Option<usize>) -> Result<Self, RecordError> {
        Self::with_channels(path.as_ref(), [MOMENTS.into(), TACTILE.into()], finger)
    }

    /// Creates a file for wrenches instead of tactile frames, and for images of `finger` if given.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn create_for_wrenches(
        path: impl AsRef<Path>,
        finger: Option<usize>,
    ) -> Result<Self, RecordError> {
        Self::with_channels(path.as_ref(), [MOMENTS.into(), WRENCH.into()], finger)
    }

    /// Creates a file for tactile frames and [`Contact`] messages.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn create_for_contacts(path: impl AsRef<Path>) -> Result<Self, RecordError> {
        Self::with_channels(path.as_ref(), [TACTILE.into(), CONTACT.into()], None)
    }

    fn with_channels(
        path: &Path,
        channels: [Channel; 2],
        finger: Option<usize>,
    ) -> Result<Self, RecordError> {
        let pictures = finger.map(|finger| Channel::from(topics::image(finger)));
        let channels: Vec<_> = channels.into_iter().chain(pictures).collect();
        let container = Container::create(path, WriteOptions::new())?;
        let fingers = finger.map_or(0, |finger| finger.saturating_add(1));
        Self::in_container(container, channels, fingers)
    }

    /// Creates a writer of `channels`, which are of the rig or of up to `fingers` fingers.
    pub(super) fn in_container(
        mut container: Container,
        channels: Vec<Channel>,
        fingers: usize,
    ) -> Result<Self, RecordError> {
        container.register(&channels)?;
        Ok(Self {
            container,
            channels,
            fingers,
            buffer: Vec::new(),
        })
    }

    /// Passes buffered messages to the operating system.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn flush(&mut self) -> Result<(), RecordError> {
        self.container.flush()
    }

    /// Writes the end of the file and closes it.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn finish(self) -> Result<(), RecordError> {
        self.container.close()
    }
}

impl MessageSink for SensedWriter {
    fn write<M: RecordedMessage>(
        &mut self,
        topic: RecordedTopic<M>,
        message: &M,
    ) -> Result<(), RecordError> {
        let channel = find(&self.channels, self.fingers, topic)?;
        let log_time = log_time(topic, message)?;
        self.buffer.clear();
        cdr::encode(message, &mut self.buffer)?;
        match self.container.stored(channel) {
            Some(make) => self
                .container
                .write(channel, log_time, &make(&self.buffer)?),
            None => self.container.write(channel, log_time, &self.buffer),
        }
    }
}

/// Reads the [`Moments`] of a file written by [`SensedWriter`], in order. From a truncated file, complete messages are
/// returned.
///
/// # Errors
/// If the file cannot be read or contains no moments.
pub fn read_moments(path: &Path) -> Result<Vec<Moments>, RecordError> {
    let file = File::open(path).map_err(RecordError::file(path))?;
    let (mut channels, mut moments) = (HashSet::new(), Vec::new());
    let scanned = scan(&mut BufReader::new(file), &mut |found| {
        match found {
            Found::Record(Record::Channel(channel), _) if channel.topic == MOMENTS.name() => {
                channels.insert(channel.id);
            }
            Found::Record(Record::Message { header, data }, _)
                if channels.contains(&header.channel_id) =>
            {
                moments.push(cdr::decode(&data).map_err(|e| e.to_string())?);
            }
            Found::Damage(reason) => return Err(reason),
            Found::Record(..) => {}
        }
        Ok(())
    });
    if moments.is_empty() {
        let reason = scanned.err().unwrap_or_else(|| {
            let topic = MOMENTS.name();
            format!(
                "no messages on {topic}; expected a file written by `feeler sense -o FILE.mcap`"
            )
        });
        return Err(RecordError::NothingReadable {
            path: path.to_path_buf(),
            reason,
        });
    }
    Ok(moments)
}
