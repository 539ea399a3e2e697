//! What a sensor felt, without any run around it: one MCAP file of ROS 2 messages, written and read.

use super::channels::{Moments, Stamped, Tactile};
use super::error::RecordError;
use super::scan::scan;
use crate::wire::{Message, cdr};
use ::mcap::records::{MessageHeader, Record};
use ::mcap::write::NoSeek;
use ::mcap::{McapError, WriteOptions, Writer};
use std::collections::{BTreeMap, HashSet};
use std::fs::File;
use std::io::{BufReader, BufWriter, Write as _};
use std::path::{Path, PathBuf};

/// Topic of the [`Moments`].
pub const MOMENTS_TOPIC: &str = "/moments";
/// Topic of the [`Tactile`] frames.
pub const TACTILE_TOPIC: &str = "/tactile";

/// Writes [`Moments`] and [`Tactile`] frames to a file.
///
/// Until it is [finished](Self::finish) the file lacks its end, and MCAP readers say so.
pub struct SensedWriter {
    path: PathBuf,
    writer: Writer<NoSeek<BufWriter<File>>>,
    moments: Channel,
    tactile: Channel,
    buffer: Vec<u8>,
}

struct Channel {
    id: u16,
    topic: &'static str,
    sequence: u32,
}

impl SensedWriter {
    /// Creates the file.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn create(path: impl AsRef<Path>) -> Result<Self, RecordError> {
        let path = path.as_ref().to_path_buf();
        let file = File::create(&path).map_err(|source| RecordError::File {
            path: path.clone(),
            source,
        })?;
        let options = WriteOptions::new()
            .profile("ros2")
            .library(concat!("feeler ", env!("CARGO_PKG_VERSION")))
            .compression(None)
            .disable_seeking(true);
        let made = options
            .create(NoSeek::new(BufWriter::new(file)))
            .and_then(|mut writer| {
                let moments = add_channel::<Moments>(&mut writer, MOMENTS_TOPIC)?;
                let tactile = add_channel::<Tactile>(&mut writer, TACTILE_TOPIC)?;
                Ok((writer, moments, tactile))
            });
        let (writer, moments, tactile) =
            made.map_err(|source| RecordError::of_mcap(&path, source))?;
        Ok(Self {
            path,
            writer,
            moments,
            tactile,
            buffer: Vec::new(),
        })
    }

    /// Writes what one picture says before any calibration.
    ///
    /// # Errors
    /// When the file cannot be written, or the stamp is no time.
    pub fn moments(&mut self, message: &Moments) -> Result<(), RecordError> {
        let written = write(
            &mut self.writer,
            &mut self.moments,
            &mut self.buffer,
            message,
        )?;
        written.map_err(|source| self.failed(source))
    }

    /// Writes one tactile frame.
    ///
    /// # Errors
    /// When the file cannot be written, or the stamp is no time.
    pub fn tactile(&mut self, message: &Tactile) -> Result<(), RecordError> {
        let written = write(
            &mut self.writer,
            &mut self.tactile,
            &mut self.buffer,
            message,
        )?;
        written.map_err(|source| self.failed(source))
    }

    /// Writes the end of the file and closes it.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn finish(mut self) -> Result<(), RecordError> {
        let finished = self.writer.finish();
        finished.map_err(|source| self.failed(source))?;
        let flushed = self.writer.into_inner().into_inner().flush();
        flushed.map_err(|source| RecordError::File {
            path: self.path,
            source,
        })
    }

    fn failed(&self, source: McapError) -> RecordError {
        RecordError::of_mcap(&self.path, source)
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
    let scanned = scan(&mut BufReader::new(file), &mut |record, _| {
        match record {
            Record::Channel(channel) if channel.topic == MOMENTS_TOPIC => {
                channels.insert(channel.id);
            }
            Record::Message { header, data } if channels.contains(&header.channel_id) => {
                moments.push(cdr::decode(&data).map_err(|e| e.to_string())?);
            }
            _ => {}
        }
        Ok(())
    });
    if moments.is_empty() {
        let reason = scanned.err().unwrap_or_else(|| {
            format!("there is nothing on {MOMENTS_TOPIC}; expected what `feeler sense -o FILE.mcap` writes")
        });
        return Err(RecordError::NothingReadable {
            path: path.to_path_buf(),
            reason,
        });
    }
    Ok(moments)
}

fn add_channel<M: Message>(
    writer: &mut Writer<NoSeek<BufWriter<File>>>,
    topic: &'static str,
) -> Result<Channel, McapError> {
    let schema = writer.add_schema(M::SCHEMA_NAME, "ros2msg", M::SCHEMA.as_bytes())?;
    let id = writer.add_channel(schema, topic, "cdr", &BTreeMap::new())?;
    Ok(Channel {
        id,
        topic,
        sequence: 0,
    })
}

/// Writes a message; the inner error is the file's.
fn write<M: Stamped>(
    writer: &mut Writer<NoSeek<BufWriter<File>>>,
    channel: &mut Channel,
    buffer: &mut Vec<u8>,
    message: &M,
) -> Result<Result<(), McapError>, RecordError> {
    let stamp = message.stamp();
    let log_time = super::recorder::nanoseconds(stamp).ok_or_else(|| RecordError::Stamp {
        topic: channel.topic.into(),
        stamp,
    })?;
    buffer.clear();
    cdr::encode(message, buffer)?;
    let header = MessageHeader {
        channel_id: channel.id,
        sequence: channel.sequence,
        log_time,
        publish_time: log_time,
    };
    channel.sequence = channel.sequence.wrapping_add(1);
    Ok(writer.write_to_known_channel(&header, buffer))
}
