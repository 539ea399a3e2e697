//! Videos of a marker gel, decoded by ffmpeg.
//!
//! Markers are located in single frames and not followed from one to the next: what is lost for a moment, or jumps, does no
//! harm. So there are places, of which [`ContactLoss`](feeler::control::grasp_slip::ContactLoss) can say whether they are
//! a pattern, and no displacements.

use super::collected::Read;
use super::notes::Notes;
use super::recorded::RecordedOptions;
use super::sources::Source;
use feeler::sensor::camera::{Camera, CameraError};
use feeler::sensor::frame::{Frame, Picture as Grey};
use feeler::sensor::locate::{LocateConfig, Located, ReferencePicture, locate, locate_again};
use feeler_console::CommandError;
use feeler_lab::grasps::{GraspFrame, GraspRecording, Picture, Untouched};
use feeler_sources::video_file::{Ffmpeg, VideoFile};
use glam::DVec2;

/// How often markers are located, Hz: several times within the half second that a loss takes to be told.
const LOOKS: f64 = 10.0;

/// Reads videos.
pub struct Videos {
    rate: Option<f64>,
}

impl Videos {
    /// As the options say.
    ///
    /// # Errors
    /// When there is no ffmpeg.
    pub fn new(options: &RecordedOptions) -> Result<Self, CommandError> {
        Ffmpeg::find()?;
        Ok(Self { rate: options.rate })
    }

    /// The recording in the video of `source`.
    ///
    /// # Errors
    /// When it cannot be decoded, or markers were located in none of its frames.
    pub fn read(&self, source: &Source, notes: &mut Notes) -> Result<Vec<Read>, CommandError> {
        let Some(path) = source.tables.first() else {
            return Ok(Vec::new());
        };
        let refused = |what: &dyn std::fmt::Display| -> CommandError {
            format!("{}: {what}; expected a video of markers", path.display()).into()
        };
        let mut video = VideoFile::open(path)?.at_rate(self.rate);
        let rate = self.rate.or(video.rate());
        let every = rate.map_or(1, |rate| (rate / LOOKS).floor().max(1.0) as u64);
        let (width, height) = video.size();
        let mut frame = Frame::black(width, height);
        let mut locator = Locator::default();
        let (mut frames, mut failed) = (Vec::new(), None);
        let ended = loop {
            if let Err(ended) = video.capture(&mut frame) {
                break ended;
            }
            if frame.sequence.is_multiple_of(every) {
                let places = locator.places(&frame.picture);
                let found = places.unwrap_or_else(|error| {
                    failed.get_or_insert(error);
                    Vec::new()
                });
                frames.push(GraspFrame {
                    stamp: frame.stamp,
                    shear: found,
                    normal: Vec::new(),
                });
            }
        };
        match ended {
            CameraError::Ended { .. } => {}
            damaged => notes.add("ffmpeg", || format!("{damaged}; these count")),
        }
        let empty = frames.iter().filter(|frame| frame.shear.is_empty()).count();
        if let Some(error) = failed {
            let (name, all) = (&source.name, frames.len());
            notes.add("markers", || format!("{name}: in {empty} of {all} frames no markers were located, the first because of: {error}"));
        }
        if empty == frames.len() {
            return Err(refused(&"no markers located in any frame"));
        }
        Ok(vec![Read {
            names: vec![source.stem().to_owned(), source.name.clone()],
            recording: GraspRecording {
                untouched: Untouched::Afresh(Picture::of_size(width, height)),
                origins: Vec::new(),
                frames,
            },
        }])
    }
}

/// Locates the markers in one picture of a video after the other.
#[derive(Default)]
struct Locator {
    /// What was found in the first picture that shows markers; all others are searched for the same.
    first: Option<Located>,
}

impl Locator {
    /// Where the markers are in a picture, px.
    fn places(&mut self, picture: &Grey) -> Result<Vec<DVec2>, CommandError> {
        let picture = ReferencePicture::mean([picture])?;
        let config = LocateConfig::default();
        let located = match &self.first {
            Some(first) => locate_again(&picture, &config, first)?,
            None => locate(&picture, &config)?,
        };
        let places = located.elements.iter().map(|element| element.centre_px);
        let places = places.collect();
        self.first.get_or_insert(located);
        Ok(places)
    }
}
