//! Frames named in CSV files or on the command line: image files, frames of videos, and frames of recordings made by
//! `feeler sense`, which contain either images or only moments.

use feeler::sensor::image::{Camera, Frame, Picture};
use feeler::sensor::moments::ElementMoments;
use feeler_record::{Moments, SensedPictures, read_moments};
use feeler_sources::{VideoFile, VideoFrames, is_video_name, read_picture};
use glam::DVec2;
use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

/// Reads frames by name, relative to a folder. Each recording is opened once.
pub struct NamedFrames {
    folder: PathBuf,
    /// Width and height of the sensor's images (px).
    size: (usize, usize),
    recordings: HashMap<PathBuf, Result<Recorded, String>>,
    /// The only video that is currently being decoded.
    decoding: Option<PathBuf>,
}

/// A recording and the timestamps of its frames.
struct Recorded {
    /// Timestamps (s).
    stamps: Vec<f64>,
    frames: Frames,
}

/// Recorded content of the frames.
enum Frames {
    Pictures(SensedPictures),
    Moments(Vec<Moments>),
    Video(Box<VideoFrames>),
}

/// Content of one frame.
pub enum NamedFrame {
    /// An image with the resolution of the sensor.
    Picture(Picture),
    /// No image; the recorded moments have been copied to the caller's buffer.
    Sensed,
}

/// Splits `FILE.mcap@TIME` or `FILE.mp4@TIME` into the file and the time (s).
fn recorded(name: &str) -> Option<(&str, f64)> {
    let (file, time) = name.rsplit_once('@')?;
    let path = Path::new(file);
    let is_recording = path.extension()?.eq_ignore_ascii_case("mcap") || is_video_name(path);
    let time = time.parse().ok().filter(|time: &f64| time.is_finite())?;
    is_recording.then_some((file, time))
}

/// Returns the file that contains the frame `name`.
pub fn file_of(name: &Path) -> &Path {
    let recorded = name.to_str().and_then(recorded);
    recorded.map_or(name, |(file, _)| Path::new(file))
}

/// Reads the image `name`: an image file, the first frame of a video, or `FILE@TIME`, the frame nearest to that time
/// (s) of a video or of a recording with images.
///
/// # Errors
/// If the image cannot be read. The message contains the file name, the expected content and the problem.
pub fn named_picture(name: &Path) -> Result<Picture, String> {
    let named = |e: &dyn std::fmt::Display| format!("{}: {e}", name.display());
    if let Some((file, time)) = name.to_str().and_then(recorded) {
        let mut recorded = Recorded::open(Path::new(file))?;
        let nearest = nearest(&recorded.stamps, time).map_err(|e| named(&e))?;
        let picture = recorded.picture(nearest).map_err(|e| named(&e))?;
        return picture.ok_or_else(|| {
            named(&"it contains no images; expected a recording by `feeler sense --record-frames`")
        });
    }
    if !is_video_name(name) {
        return read_picture(name).map_err(|e| named(&e));
    }
    let mut video = VideoFile::open(name).map_err(|e| e.to_string())?;
    let (width, height) = video.size();
    let mut frame = Frame::black(width, height);
    video.capture(&mut frame).map_err(|e| e.to_string())?;
    Ok(frame.picture)
}

/// Returns the file at `csv` and the files of the frames it names, without duplicates.
pub fn files_of<'a>(csv: &Path, names: impl Iterator<Item = &'a str>) -> Vec<PathBuf> {
    let named = names.map(|name| folder(csv).join(recorded(name).map_or(name, |(file, _)| file)));
    let files: HashSet<_> = named.chain([csv.to_path_buf()]).collect();
    files.into_iter().collect()
}

fn folder(csv: &Path) -> &Path {
    csv.parent().unwrap_or(Path::new(""))
}

impl NamedFrames {
    /// Creates a reader of the frames named in the file at `csv`. `size` is the width and height of the sensor's
    /// images (px).
    pub fn new(csv: &Path, size: (usize, usize)) -> Self {
        Self {
            folder: folder(csv).to_path_buf(),
            size,
            recordings: HashMap::new(),
            decoding: None,
        }
    }

    /// Reads the frame `name`: an image file, or `FILE.mcap@TIME` or `FILE.mp4@TIME`, the frame nearest to that time
    /// (s), which must be within half a frame interval. If a recording has no images, its moments are copied to
    /// `moments`.
    ///
    /// # Errors
    /// If the frame cannot be read. The message contains the expected content and the problem.
    pub fn get(
        &mut self,
        name: &str,
        moments: &mut [ElementMoments],
    ) -> Result<NamedFrame, String> {
        let (width, height) = self.size;
        let Some((file, time)) = recorded(name) else {
            let path = self.folder.join(name);
            if is_video_name(&path) {
                return Err(
                    "the file is a video; expected FILE@TIME with the time of a frame in seconds, as in clip.mp4@1.5"
                        .into(),
                );
            }
            let picture = read_picture(&path);
            let picture =
                picture.map_err(|e| format!("{e}; expected an image of {width}x{height} px"))?;
            return self.checked(picture);
        };
        let path = self.folder.join(file);
        self.stop_decoding_others(&path);
        let recorded = match self.recordings.entry(path) {
            Entry::Occupied(entry) => entry.into_mut(),
            Entry::Vacant(entry) => {
                let opened = Recorded::open(entry.key());
                entry.insert(opened)
            }
        };
        let recorded = recorded.as_mut().map_err(|e| e.clone())?;
        let nearest = nearest(&recorded.stamps, time)?;
        if let Frames::Moments(frames) = &recorded.frames {
            take(&frames[nearest], moments)?;
            return Ok(NamedFrame::Sensed);
        }
        let picture = recorded.picture(nearest)?.ok_or("the frame has no image")?;
        self.checked(picture)
    }

    /// Stops decoding any video other than `path`, because each decoder is a separate process.
    fn stop_decoding_others(&mut self, path: &Path) {
        if self.decoding.as_deref() == Some(path) {
            return;
        }
        let other = self.decoding.take();
        let other = other.and_then(|other| self.recordings.get_mut(&other));
        if let Some(Ok(Recorded {
            frames: Frames::Video(video),
            ..
        })) = other
        {
            video.close();
        }
        self.decoding = Some(path.to_path_buf());
    }

    /// Returns the image if it has the sensor's size.
    fn checked(&self, picture: Picture) -> Result<NamedFrame, String> {
        let (width, height) = self.size;
        let (columns, rows) = (picture.width, picture.height);
        if (columns, rows) == (width, height) {
            return Ok(NamedFrame::Picture(picture));
        }
        Err(format!(
            "the image has {columns}x{rows} px; expected {width}x{height} px"
        ))
    }
}

impl Recorded {
    fn open(path: &Path) -> Result<Self, String> {
        if is_video_name(path) {
            let video = VideoFrames::open(path).map_err(|e| e.to_string())?;
            return Ok(Self {
                stamps: video.stamps().to_vec(),
                frames: Frames::Video(Box::new(video)),
            });
        }
        let pictures = SensedPictures::open(path).map_err(|e| e.to_string())?;
        if !pictures.is_empty() {
            return Ok(Self {
                stamps: pictures.stamps().collect(),
                frames: Frames::Pictures(pictures),
            });
        }
        let moments = read_moments(path).map_err(|e| e.to_string())?;
        Ok(Self {
            stamps: moments.iter().map(|frame| frame.stamp).collect(),
            frames: Frames::Moments(moments),
        })
    }

    /// Returns the image of frame `index`, or `None` if the recording contains no images.
    fn picture(&mut self, index: usize) -> Result<Option<Picture>, String> {
        match &mut self.frames {
            Frames::Pictures(pictures) => Ok(Some(pictures.read(index)?)),
            Frames::Video(video) => {
                let picture = video.read(index).map_err(|e| e.to_string())?;
                Ok(Some(picture.clone()))
            }
            Frames::Moments(_) => Ok(None),
        }
    }
}

/// Returns the index of the frame nearest to `time` (s).
fn nearest(stamps: &[f64], time: f64) -> Result<usize, String> {
    let off = |stamp: f64| (stamp - time).abs();
    let frames = stamps.iter().copied().enumerate();
    let nearest = frames.min_by(|(_, a), (_, b)| off(*a).total_cmp(&off(*b)));
    let (index, stamp) = nearest.ok_or("the recording is empty")?;
    let (first, last) = (stamps[0], stamps[stamps.len() - 1]);
    let spacing = (last - first) / (stamps.len() - 1).max(1) as f64;
    // Slightly more than half an interval, to allow for rounded times.
    if off(stamp) > 0.501 * spacing + 1e-6 {
        return Err(format!(
            "the nearest frame is at {stamp} s; expected a time from {first} to {last} s"
        ));
    }
    Ok(index)
}

/// Copies the moments of a recorded frame.
fn take(frame: &Moments, moments: &mut [ElementMoments]) -> Result<(), String> {
    let lists = [&frame.integrated_gray, &frame.centroid_x, &frame.centroid_y];
    if let Some(list) = lists.iter().find(|list| list.len() != moments.len()) {
        let (actual, expected) = (list.len(), moments.len());
        return Err(format!(
            "the recording has {actual} elements; expected {expected}, or a recording with images (`feeler sense --record-frames`)"
        ));
    }
    for (element, moments) in moments.iter_mut().enumerate() {
        let centroid = DVec2::new(frame.centroid_x[element], frame.centroid_y[element]);
        *moments = ElementMoments {
            integrated_gray: frame.integrated_gray[element],
            centroid: if centroid.is_finite() {
                centroid
            } else {
                DVec2::ZERO
            },
        };
    }
    Ok(())
}
