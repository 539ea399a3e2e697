//! The frames that a CSV file names: pictures, and frames of recordings that `feeler sense` made; of these their pictures, where
//! they were kept, else what was sensed of them.

use feeler::sensor::frame::Picture;
use feeler::sensor::moments::ElementMoments;
use feeler_record::{Moments, SensedPictures, read_moments};
use feeler_sources::picture::read_picture;
use glam::DVec2;
use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

/// Frames by their names, in a folder. Each recording is opened once.
pub struct NamedFrames {
    folder: PathBuf,
    /// Width and height of the sensor's pictures, px.
    size: (usize, usize),
    recordings: HashMap<PathBuf, Recorded>,
}

/// A recording, and when its frames were taken.
struct Recorded {
    /// s.
    stamps: Vec<f64>,
    frames: Frames,
}

/// What is on record of each frame.
enum Frames {
    Pictures(SensedPictures),
    Moments(Vec<Moments>),
}

/// What there is of one frame.
pub enum NamedFrame {
    /// Its picture, of the sensor's size.
    Picture(Picture),
    /// No picture, but its moments, which have been taken.
    Sensed,
}

/// The recording and the time (s) that `FILE.mcap@TIME` names.
fn recorded(name: &str) -> Option<(&str, f64)> {
    let (file, time) = name.rsplit_once('@')?;
    let is_recording = Path::new(file).extension()?.eq_ignore_ascii_case("mcap");
    let time = time.parse().ok().filter(|time: &f64| time.is_finite())?;
    is_recording.then_some((file, time))
}

/// The file at `csv`, and the files of the frames that it names, each once.
pub fn files_of<'a>(csv: &Path, names: impl Iterator<Item = &'a str>) -> Vec<PathBuf> {
    let named = names.map(|name| folder(csv).join(recorded(name).map_or(name, |(file, _)| file)));
    let files: HashSet<_> = named.chain([csv.to_path_buf()]).collect();
    files.into_iter().collect()
}

fn folder(csv: &Path) -> &Path {
    csv.parent().unwrap_or(Path::new(""))
}

impl NamedFrames {
    /// The frames that the file at `csv` names, of a sensor whose pictures have this `size` (width, height), px.
    pub fn new(csv: &Path, size: (usize, usize)) -> Self {
        Self {
            folder: folder(csv).to_path_buf(),
            size,
            recordings: HashMap::new(),
        }
    }

    /// The frame called `name`: a picture's file, or `FILE.mcap@TIME`, which names the frame nearest to that time (s); it must be
    /// within half of the time between frames. Where a recording has no pictures, takes its `moments`.
    ///
    /// # Errors
    /// What was expected and what was found, in words.
    pub fn get(
        &mut self,
        name: &str,
        moments: &mut [ElementMoments],
    ) -> Result<NamedFrame, String> {
        let (width, height) = self.size;
        let Some((file, time)) = recorded(name) else {
            let picture = read_picture(&self.folder.join(name));
            let picture =
                picture.map_err(|e| format!("{e}; expected a picture of {width}x{height} px"))?;
            return self.checked(picture);
        };
        let recorded = match self.recordings.entry(self.folder.join(file)) {
            Entry::Occupied(entry) => entry.into_mut(),
            Entry::Vacant(entry) => {
                let opened = Recorded::open(entry.key())?;
                entry.insert(opened)
            }
        };
        let nearest = nearest(&recorded.stamps, time)?;
        match &mut recorded.frames {
            Frames::Pictures(pictures) => {
                let picture = pictures.read(nearest)?;
                self.checked(picture)
            }
            Frames::Moments(frames) => {
                take(&frames[nearest], moments)?;
                Ok(NamedFrame::Sensed)
            }
        }
    }

    /// The picture, unless it is of another size than the sensor's.
    fn checked(&self, picture: Picture) -> Result<NamedFrame, String> {
        let (width, height) = self.size;
        let (columns, rows) = (picture.width, picture.height);
        if (columns, rows) == (width, height) {
            return Ok(NamedFrame::Picture(picture));
        }
        Err(format!(
            "it has {columns}x{rows} px; expected a picture of {width}x{height} px"
        ))
    }
}

impl Recorded {
    fn open(path: &Path) -> Result<Self, String> {
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
}

/// The frame nearest to `time`, s.
fn nearest(stamps: &[f64], time: f64) -> Result<usize, String> {
    let off = |stamp: f64| (stamp - time).abs();
    let frames = stamps.iter().copied().enumerate();
    let nearest = frames.min_by(|(_, a), (_, b)| off(*a).total_cmp(&off(*b)));
    let (index, stamp) = nearest.ok_or("the recording is empty")?;
    let (first, last) = (stamps[0], stamps[stamps.len() - 1]);
    let spacing = (last - first) / (stamps.len() - 1).max(1) as f64;
    // A hair more than half of it, for times that were rounded.
    if off(stamp) > 0.501 * spacing + 1e-6 {
        return Err(format!(
            "the nearest frame is at {stamp} s; expected a time from {first} to {last} s"
        ));
    }
    Ok(index)
}

/// Takes the moments of a recorded frame.
fn take(frame: &Moments, moments: &mut [ElementMoments]) -> Result<(), String> {
    let lists = [&frame.integrated_gray, &frame.centroid_x, &frame.centroid_y];
    if let Some(list) = lists.iter().find(|list| list.len() != moments.len()) {
        let (actual, expected) = (list.len(), moments.len());
        return Err(format!(
            "it was recorded of {actual} elements; expected {expected}, or its pictures (`feeler sense --record-frames`)"
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
