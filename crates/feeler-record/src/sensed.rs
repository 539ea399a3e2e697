//! What a sensor felt, without any run around it: one MCAP file of ROS 2 messages, written and read.

use super::channels::{Moments, Tactile};
use super::container::{Container, find, log_time};
use super::error::RecordError;
use super::memory::MessageSink;
use super::scan::{Found, scan};
use super::topic::{Channel, RecordedMessage, RecordedTopic};
use crate::wire::cdr;
use ::mcap::WriteOptions;
use ::mcap::records::Record;
use std::collections::HashSet;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// What pictures say before any calibration.
pub const MOMENTS: RecordedTopic<Moments> = RecordedTopic::of_rig("moments");
/// Tactile frames of the one fingertip.
pub const TACTILE: RecordedTopic<Tactile> = RecordedTopic::of_rig("tactile");

/// Writes [`Moments`] to [`MOMENTS`] and [`Tactile`] frames to [`TACTILE`] of a file.
///
/// Until it is [finished](Self::finish) the file lacks its end, and MCAP readers say so.
pub struct SensedWriter {
    container: Container,
    channels: [Channel; 2],
    buffer: Vec<u8>,
}

impl SensedWriter {
    /// Creates the file.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn create(path: impl AsRef<Path>) -> Result<Self, RecordError> {
        let mut container = Container::create(path.as_ref(), WriteOptions::new())?;
        let channels = [MOMENTS.into(), TACTILE.into()];
        container.register(&channels)?;
        Ok(Self {
            container,
            channels,
            buffer: Vec::new(),
        })
    }

    /// Hands what was written to the system.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn flush(&mut self) -> Result<(), RecordError> {
        self.container.flush()
    }

    /// Writes the end of the file and closes it.
    ///
    /// # Errors
    /// When the file cannot be written.
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
        let channel = find(&self.channels, 0, topic)?;
        let log_time = log_time(topic, message)?;
        self.buffer.clear();
        cdr::encode(message, &mut self.buffer)?;
        self.container.write(channel, log_time, &self.buffer)
    }
}

/// Reads the [`Moments`] of a file that [`SensedWriter`] wrote, in order; of one that was cut short,
/// what is whole.
///
/// # Errors
/// When the file cannot be read or holds no moments.
pub fn read_moments(path: &Path) -> Result<Vec<Moments>, RecordError> {
    let file = File::open(path).map_err(|source| RecordError::File {
        path: path.to_path_buf(),
        source,
    })?;
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
            format!("there is nothing on {topic}; expected what `feeler sense -o FILE.mcap` writes")
        });
        return Err(RecordError::NothingReadable {
            path: path.to_path_buf(),
            reason,
        });
    }
    Ok(moments)
}
