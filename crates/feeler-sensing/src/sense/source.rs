//! Parses the source argument and opens its camera.

use super::SenseOptions;
use crate::camera::CameraName;
use feeler::sensor::image::Camera;
use feeler_console::CommandError;
use feeler_record::SensedPictures;
use feeler_record::sensed::is_sensed;
use feeler_report::run::make::RECORDING;
use feeler_sources::{PictureFiles, RawFrames, VideoFile, is_video_name};
use std::io::stdin;
use std::path::{Path, PathBuf};

/// Prefix of the name of a source on a serial port.
pub const SERIAL: &str = "serial:";

/// A source of readings.
#[derive(Debug, PartialEq)]
pub enum Source {
    /// Folders and files of images.
    Pictures(Vec<PathBuf>),
    /// Raw grey frames of this size (columns, rows; px) on standard input.
    Raw((usize, usize)),
    /// A camera.
    Camera(CameraName),
    /// A recorded run.
    Recording(PathBuf),
    /// A recording of a sensor's images.
    Sensed(PathBuf),
    /// A video file.
    Video(PathBuf),
    /// A rig served by another program.
    Rig,
}

impl Source {
    /// Determines the source from the options.
    pub fn of(options: &SenseOptions) -> Result<Self, CommandError> {
        let source = Self::named(&options.sources, options.raw)?;
        let raw = matches!(source, Self::Raw(_));
        let camera = matches!(source, Self::Camera(_));
        let recording = matches!(source, Self::Recording(_));
        let of_no_use = [
            (
                "--raw",
                options.raw.is_some() && !raw,
                "raw frames on standard input (-)",
            ),
            ("--size", options.size.is_some() && !camera, "a camera"),
            (
                "--record-frames",
                options.record_frames && recording,
                "images",
            ),
            (
                options.camera.given().unwrap_or_default(),
                options.camera.given().is_some() && !camera,
                "a camera",
            ),
            (
                "--finger",
                options.finger.is_some() && !recording && options.layout.is_some(),
                "a recorded run or an experiment's fingertip",
            ),
            ("--layout", options.layout.is_some() && recording, "images"),
            (
                "--calibration",
                options.calibration.is_some() && recording,
                "images",
            ),
            (
                "--reference",
                options.reference.is_some() && recording,
                "images",
            ),
            (
                "--unloaded",
                options.unloaded.is_some() && recording,
                "images",
            ),
        ];
        match of_no_use.into_iter().find(|&(_, given, _)| given) {
            Some((flag, _, what)) => Err(format!(
                "{flag} requires {what}, got {}",
                options.sources[0].display()
            )
            .into()),
            None => Ok(source),
        }
    }

    /// Returns `true` if the source ends only when interrupted. An interrupted stream is complete.
    pub fn is_stream(&self) -> bool {
        matches!(self, Self::Raw(_) | Self::Camera(_) | Self::Rig)
    }

    fn named(paths: &[PathBuf], raw: Option<(usize, usize)>) -> Result<Self, CommandError> {
        let [path] = paths else {
            return match paths.iter().find(|path| is_video_name(path)) {
                Some(video) => {
                    let video = video.display();
                    Err(format!("{video}: expected a single video, or only images").into())
                }
                None => Ok(Self::Pictures(paths.to_vec())),
            };
        };
        if path.to_str().is_some_and(|name| name.starts_with(SERIAL)) {
            let path = path.display();
            return Err(format!(
                "{path}: requires --taxels LAYOUT, the layout of the skin (see `feeler list`)"
            )
            .into());
        }
        if path == Path::new("rig:") {
            return Ok(Self::Rig);
        }
        if let Some(name) = CameraName::parse(path) {
            return Ok(Self::Camera(name));
        }
        if path == Path::new("-") {
            let size = raw.ok_or("-: expected --raw WIDTHxHEIGHT, the size of the frames")?;
            return Ok(Self::Raw(size));
        }
        let recording = path.join(RECORDING);
        if recording.is_file() {
            return Ok(Self::Recording(recording));
        }
        if path
            .extension()
            .is_some_and(|extension| extension == "mcap")
        {
            return Ok(match is_sensed(path) {
                true => Self::Sensed(path.clone()),
                false => Self::Recording(path.clone()),
            });
        }
        if is_video_name(path) && !path.is_dir() {
            return Ok(Self::Video(path.clone()));
        }
        Ok(Self::Pictures(vec![path.clone()]))
    }

    /// Opens the camera of the source, whose images must have `size` (columns, rows; px).
    pub fn camera(
        &self,
        options: &SenseOptions,
        size: (usize, usize),
    ) -> Result<Box<dyn Camera + Send>, CommandError> {
        match self {
            Self::Pictures(paths) => Ok(Box::new(PictureFiles::new(paths, size, options.rate())?)),
            Self::Sensed(path) => sensed_pictures(path),
            Self::Video(path) => {
                let video = VideoFile::open(path)?;
                check_size(&path.display().to_string(), video.size(), size)?;
                Ok(Box::new(video.at_rate(options.rate)))
            }
            Self::Raw(raw) => {
                check_size("--raw", *raw, size)?;
                Ok(Box::new(RawFrames::new(stdin(), size, options.rate())))
            }
            Self::Camera(name) => {
                check_size("--size", options.size.unwrap_or(size), size)?;
                let settings = options.camera.settings(size, options.rate());
                Ok(name.open(settings)?.camera)
            }
            Self::Rig => Err("rig: its images are received over the link".into()),
            Self::Recording(path) => {
                let path = path.display();
                Err(
                    format!("{path}: expected images, got a recorded run; use `feeler replay`")
                        .into(),
                )
            }
        }
    }
}

/// Opens the images in a sensor's recording at `path`.
fn sensed_pictures(path: &Path) -> Result<Box<dyn Camera + Send>, CommandError> {
    let pictures = SensedPictures::open(path)?;
    if pictures.is_empty() {
        return Err(format!(
            "{}: contains no images; expected a recording made by `feeler sense --record-frames`",
            path.display()
        )
        .into());
    }
    Ok(Box::new(pictures))
}

/// Rejects frames whose size differs from the fingertip's.
fn check_size(
    flag: &str,
    (width, height): (usize, usize),
    expected: (usize, usize),
) -> Result<(), CommandError> {
    if (width, height) == expected {
        return Ok(());
    }
    Err(format!(
        "{flag} {width}x{height}: expected the size of the fingertip's images, {}x{} px; change the size or the fingertip \
         (--layout, written by `feeler locate`, or --experiment)",
        expected.0, expected.1
    )
    .into())
}
