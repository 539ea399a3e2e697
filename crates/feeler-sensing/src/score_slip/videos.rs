//! Videos of a marker gel, decoded by ffmpeg.
//!
//! Markers are located in each frame separately and not tracked, so jumping or temporarily lost markers cause no
//! errors. This yields positions, in which [`ContactLoss`](feeler::control::grasp_slip::ContactLoss) can recognize a
//! pattern, but no displacements.

use super::notes::Notes;
use super::options::RecordedOptions;
use super::sources::{Read, Source};
use feeler::control::grasp_slip::CoarseImage;
use feeler::sensor::image::{Camera, CameraError, Frame, Picture as Grey};
use feeler::sensor::locate::{LocateConfig, Located, ReferencePicture, locate, locate_again};
use feeler_console::CommandError;
use feeler_lab::grasps::{ContactReference, GraspFrame, GraspRecording, Picture};
use feeler_sources::{Ffmpeg, VideoFile};
use glam::DVec2;

/// Rate at which markers are located (Hz): five times within the 0.5 s after which a loss is reported.
const LOOKS: f64 = 10.0;

/// Reader of videos.
pub struct Videos {
    rate: Option<f64>,
}

impl Videos {
    /// Creates a reader with the options in `options`.
    ///
    /// # Errors
    /// If ffmpeg is not found.
    pub fn new(options: &RecordedOptions) -> Result<Self, CommandError> {
        Ffmpeg::find()?;
        Ok(Self { rate: options.rate })
    }

    /// Reads the recording in the video of `source`.
    ///
    /// # Errors
    /// If it cannot be decoded, or no frame shows markers.
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
        let (mut frames, mut images, mut failed) = (Vec::new(), Vec::new(), None);
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
                images.push(CoarseImage::of(&frame.picture));
                frames.push(GraspFrame {
                    stamp: frame.stamp,
                    shear: found,
                    normal: Vec::new(),
                });
            }
        };
        match ended {
            CameraError::Ended { .. } => {}
            damaged => notes.add("ffmpeg", || format!("{damaged}; these are used")),
        }
        let empty = frames.iter().filter(|frame| frame.shear.is_empty()).count();
        if let Some(error) = failed {
            let (name, all) = (&source.name, frames.len());
            notes.add("markers", || {
                format!(
                    "{name}: no markers located in {empty} of {all} frames; first error: {error}"
                )
            });
        }
        if empty == frames.len() {
            return Err(refused(&"no markers located in any frame"));
        }
        Ok(vec![Read {
            names: vec![source.stem().to_owned(), source.name.clone()],
            recording: GraspRecording {
                untouched: ContactReference::LocatedPattern(Picture::of_size(width, height)),
                origins: Vec::new(),
                frames,
            },
            images,
        }])
    }
}

/// Locates the markers in successive images of a video.
#[derive(Default)]
struct Locator {
    /// Markers of the first image that shows any. All other images are searched for the same markers.
    first: Option<Located>,
}

impl Locator {
    /// Returns the positions of the markers in an image (px).
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
