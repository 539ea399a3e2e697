//! A camera that plays back the images in a sensor's recording.

use super::readings::MOMENTS;
use crate::error::RecordError;
use crate::messages::channels::{Moments, nanoseconds};
use crate::messages::topic::topics;
use crate::reading::picture_reader::PictureReader;
use crate::reading::recording::PictureAt;
use crate::reading::scan::{Found, scan};
use crate::wire::cdr;
use crate::writing::sink::FACTS;
use ::mcap::records::Record;
use feeler::sensor::image::{Camera, CameraError, Frame, Picture, check_frame_size};
use std::collections::HashSet;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// A frame with a recorded image.
#[derive(Debug, Clone, Copy, PartialEq)]
struct SensedFrame {
    sequence: u64,
    /// Time (s).
    stamp: f64,
    picture: PictureAt,
}

/// A camera that plays back the images of a file written by [`SensedWriter`](crate::SensedWriter), with their original
/// sequence numbers and exact stamps. Images are read from the file on demand.
#[derive(Debug)]
pub struct SensedPictures {
    path: PathBuf,
    file: PictureReader<File>,
    frames: Vec<SensedFrame>,
    next: usize,
    /// Reason why images may be missing at the end.
    problem: Option<String>,
}

/// Returns `true` if the file at `path` was recorded by a sensor program alone, not during a run.
pub fn is_sensed(path: &Path) -> bool {
    let Ok(file) = File::open(path) else {
        return false;
    };
    let mut sensed = None;
    // Only the first record that identifies the kind of file matters; damage before it is ignored.
    let _ = scan(&mut BufReader::new(file), &mut |found| {
        match found {
            Found::Record(Record::Metadata(metadata), _) if metadata.name == FACTS => {
                sensed = Some(false);
            }
            Found::Record(Record::Channel(channel), _) if channel.topic == MOMENTS.name() => {
                sensed = Some(true);
            }
            _ => return Ok(()),
        }
        Err(String::new())
    });
    sensed.unwrap_or(false)
}

impl SensedPictures {
    /// Finds the images in the file at `path`. From a truncated file, complete images are used.
    ///
    /// # Errors
    /// If the file cannot be opened.
    pub fn open(path: &Path) -> Result<Self, RecordError> {
        let open = || File::open(path).map_err(RecordError::file(path));
        let mut index = Index::default();
        let scanned = scan(&mut BufReader::new(open()?), &mut |found| index.take(found));
        let problem = index.damage.take().or(scanned.err());
        Ok(Self {
            path: path.to_path_buf(),
            file: PictureReader::new(open()?),
            frames: index.frames(),
            next: 0,
            problem,
        })
    }

    /// Returns `true` if the file contains no images.
    pub fn is_empty(&self) -> bool {
        self.frames.is_empty()
    }

    /// Time of each frame (s).
    pub fn stamps(&self) -> impl Iterator<Item = f64> + '_ {
        self.frames.iter().map(|frame| frame.stamp)
    }

    /// Reads the image of frame `index`, from 0.
    ///
    /// # Errors
    /// If there is no such frame, or the image cannot be read. Returns a description.
    pub fn read(&mut self, index: usize) -> Result<Picture, String> {
        let count = self.frames.len();
        let frame = self.frames.get(index);
        let frame =
            frame.ok_or_else(|| format!("expected an image index below {count}, got {index}"))?;
        self.file.read(frame.picture)
    }
}

impl Camera for SensedPictures {
    fn capture(&mut self, frame: &mut Frame) -> Result<(), CameraError> {
        let (index, path) = (self.next, self.path.display().to_string());
        let Some(&SensedFrame {
            sequence, stamp, ..
        }) = self.frames.get(index)
        else {
            let count = index as u64;
            return Err(match &self.problem {
                None => CameraError::Ended { count },
                Some(problem) => CameraError::Failed(format!(
                    "{path}: the recording is incomplete ({problem}); {count} images are readable"
                )),
            });
        };
        self.next += 1;
        let (width, height) = (frame.picture.width, frame.picture.height);
        check_frame_size((width, height), frame)?;
        let name = format!("{path}: frame {sequence}");
        let picture = match self.read(index) {
            Ok(picture) => picture,
            Err(reason) => return Err(CameraError::Unreadable { name, reason }),
        };
        if (picture.width, picture.height) != (width, height) {
            return Err(CameraError::PictureSize {
                name,
                expected_width: width,
                expected_height: height,
                width: picture.width,
                height: picture.height,
            });
        }
        frame.picture = picture;
        (frame.sequence, frame.stamp) = (sequence, stamp);
        Ok(())
    }
}

/// Frames and images found in a file. A frame need not be next to its image, because moments may be written later.
#[derive(Default)]
struct Index {
    moments: HashSet<u16>,
    images: HashSet<u16>,
    /// Sequence number and stamp (s) of each frame.
    sensed: Vec<(u64, f64)>,
    pictures: Vec<PictureAt>,
    damage: Option<String>,
}

impl Index {
    fn take(&mut self, found: Found<'_>) -> Result<(), String> {
        match found {
            Found::Record(Record::Channel(channel), _) if channel.topic == MOMENTS.name() => {
                self.moments.insert(channel.id);
            }
            Found::Record(Record::Channel(channel), _) if is_image(&channel.topic) => {
                self.images.insert(channel.id);
            }
            Found::Record(Record::Message { header, data }, place) => {
                if self.moments.contains(&header.channel_id) {
                    let moments: Moments = cdr::decode(&data).map_err(|e| e.to_string())?;
                    self.sensed.push((moments.sequence, moments.stamp));
                } else if self.images.contains(&header.channel_id) {
                    let at = PictureAt::new(header.log_time, place, data.len());
                    self.pictures.push(at);
                }
            }
            Found::Damage(reason) => {
                self.damage.get_or_insert(reason);
            }
            Found::Record(..) => {}
        }
        Ok(())
    }

    /// Returns the frames that have moments and an image. Both lists are in order of time.
    fn frames(self) -> Vec<SensedFrame> {
        let mut pictures = self.pictures.into_iter().peekable();
        let frame = |(sequence, stamp)| {
            let time = nanoseconds(stamp)?;
            while pictures.next_if(|at| at.log_time < time).is_some() {}
            let picture = pictures.next_if(|at| at.log_time == time)?;
            Some(SensedFrame {
                sequence,
                stamp,
                picture,
            })
        };
        self.sensed.into_iter().filter_map(frame).collect()
    }
}

/// Returns `true` if `topic` carries the images of a finger.
fn is_image(topic: &str) -> bool {
    let finger = topic.split('/').nth(2).and_then(|n| n.parse().ok());
    finger.is_some_and(|finger| topics::image(finger).name() == topic)
}
