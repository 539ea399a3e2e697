//! Which source is meant, and its camera.

use super::{Arguments, CommandError};
use feeler::sensor::camera::Camera;
use feeler_record::SensedPictures;
use feeler_record::sensed_pictures::is_sensed;
use feeler_report::make::RECORDING;
use feeler_sources::files::PictureFiles;
use feeler_sources::raw::RawFrames;
use std::io::stdin;
use std::path::{Path, PathBuf};

/// Where readings come from.
#[derive(Debug, PartialEq)]
pub enum Source {
    /// Folders and files of pictures.
    Pictures(Vec<PathBuf>),
    /// Raw grey frames of this size (columns, rows) on standard input, px.
    Raw((usize, usize)),
    /// A Video4Linux device.
    Video(PathBuf),
    /// A run's recording.
    Recording(PathBuf),
    /// Pictures that were sensed before and kept.
    Sensed(PathBuf),
    /// The rig that another program plays.
    Rig,
}

impl Source {
    /// What the arguments mean.
    pub fn of(arguments: &Arguments) -> Result<Self, CommandError> {
        let source = Self::named(&arguments.sources, arguments.raw)?;
        let raw = matches!(source, Self::Raw(_));
        let video = matches!(source, Self::Video(_));
        let recording = matches!(source, Self::Recording(_));
        let of_no_use = [
            (
                "--raw",
                arguments.raw.is_some() && !raw,
                "raw frames on standard input (-)",
            ),
            ("--size", arguments.size.is_some() && !video, "a camera"),
            (
                "--record-frames",
                arguments.record_frames && recording,
                "pictures",
            ),
            (
                "--exposure",
                arguments.exposure.is_some() && !video,
                "a camera",
            ),
            (
                "--finger",
                arguments.finger.is_some() && !recording && arguments.layout.is_some(),
                "a recorded run or an experiment's fingertip",
            ),
            (
                "--layout",
                arguments.layout.is_some() && recording,
                "pictures",
            ),
            (
                "--calibration",
                arguments.calibration.is_some() && recording,
                "pictures",
            ),
            (
                "--reference",
                arguments.reference.is_some() && recording,
                "pictures",
            ),
            (
                "--unloaded",
                arguments.unloaded.is_some() && recording,
                "pictures",
            ),
        ];
        match of_no_use.into_iter().find(|&(_, given, _)| given) {
            Some((flag, _, what)) => Err(format!(
                "{flag} is for {what}; {} is something else",
                arguments.sources[0].display()
            )
            .into()),
            None => Ok(source),
        }
    }

    /// Whether it ends only when somebody ends it: what was sensed until then is whole.
    pub fn is_stream(&self) -> bool {
        matches!(self, Self::Raw(_) | Self::Video(_) | Self::Rig)
    }

    fn named(paths: &[PathBuf], raw: Option<(usize, usize)>) -> Result<Self, CommandError> {
        let [path] = paths else {
            return Ok(Self::Pictures(paths.to_vec()));
        };
        if path == Path::new("rig:") {
            return Ok(Self::Rig);
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
        if is_video_device(path) {
            return Ok(Self::Video(path.clone()));
        }
        Ok(Self::Pictures(vec![path.clone()]))
    }

    /// The source's camera, whose pictures must have `size` (columns, rows), px.
    pub fn camera(
        &self,
        arguments: &Arguments,
        size: (usize, usize),
    ) -> Result<Box<dyn Camera + Send>, CommandError> {
        match self {
            Self::Pictures(paths) => {
                Ok(Box::new(PictureFiles::new(paths, size, arguments.rate())?))
            }
            Self::Sensed(path) => sensed_pictures(path),
            Self::Raw(raw) => {
                check_size("--raw", *raw, size)?;
                Ok(Box::new(RawFrames::new(stdin(), size, arguments.rate())))
            }
            Self::Video(device) => {
                check_size("--size", arguments.size.unwrap_or(size), size)?;
                open_video(device, size, arguments.rate(), arguments.exposure)
            }
            Self::Rig => Err("rig: its pictures come over the link".into()),
            Self::Recording(path) => {
                let path = path.display();
                Err(format!("{path}: the pictures of a run are for `feeler replay`").into())
            }
        }
    }
}

/// The pictures in the recording of a sensor at `path`.
fn sensed_pictures(path: &Path) -> Result<Box<dyn Camera + Send>, CommandError> {
    let pictures = SensedPictures::open(path)?;
    if pictures.is_empty() {
        return Err(format!(
            "{}: there are no pictures in it; expected a recording made by `feeler sense --record-frames`",
            path.display()
        )
        .into());
    }
    Ok(Box::new(pictures))
}

/// Whether `path` is named as Video4Linux devices are; `/dev/shm` holds files.
pub fn is_video_device(path: &Path) -> bool {
    let name = path.to_string_lossy();
    name.starts_with("/dev/video") || name.starts_with("/dev/v4l/")
}

/// Refuses frames of another size than the fingertip's.
fn check_size(
    flag: &str,
    (width, height): (usize, usize),
    expected: (usize, usize),
) -> Result<(), CommandError> {
    if (width, height) == expected {
        return Ok(());
    }
    Err(format!(
        "{flag} {width}x{height}: the fingertip's pictures are of {}x{} px; expected these, or another \
         fingertip (--layout, as `feeler locate` writes it, or --experiment)",
        expected.0, expected.1
    )
    .into())
}

/// The Video4Linux camera `device`, asked for `rate` Hz and an exposure time (s).
#[cfg(all(feature = "camera", target_os = "linux"))]
pub fn open_video(
    device: &Path,
    size: (usize, usize),
    rate: f64,
    exposure: Option<f64>,
) -> Result<Box<dyn Camera + Send>, CommandError> {
    use feeler_sources::video::{VideoCamera, VideoConfig};
    let camera = VideoCamera::open(&VideoConfig {
        device: device.to_path_buf(),
        size,
        rate,
        exposure,
    })?;
    Ok(Box::new(camera))
}

#[cfg(not(all(feature = "camera", target_os = "linux")))]
pub fn open_video(
    device: &Path,
    _: (usize, usize),
    _: f64,
    _: Option<f64>,
) -> Result<Box<dyn Camera + Send>, CommandError> {
    Err(format!(
        "{}: this program was built without cameras; build it on Linux with --features camera",
        device.display()
    )
    .into())
}
