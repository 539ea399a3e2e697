//! Cameras on the command line: names and settings.

use super::CommandError;
use feeler::sensor::camera::Camera;
use feeler_sources::settings::{CameraSettings, Trigger};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Description of valid camera names, for messages.
pub const NAMES: &str = "/dev/videoN, or genicam:ID as listed by `feeler cameras`";

/// Name of a camera.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum CameraName {
    /// A Video4Linux device.
    Video(PathBuf),
    /// GenICam camera with this id, serial number or address, or the first one found if `None`.
    Genicam(Option<String>),
}

impl CameraName {
    /// Parses the name of a camera, or returns `None` if `path` is not one. `/dev/shm` contains files.
    pub fn of(path: &Path) -> Option<Self> {
        let name = path.to_string_lossy();
        if let Some(id) = name.strip_prefix("genicam:") {
            return Some(Self::Genicam(
                Some(id.into()).filter(|id: &String| !id.is_empty()),
            ));
        }
        let is_video = name.starts_with("/dev/video") || name.starts_with("/dev/v4l/");
        is_video.then(|| Self::Video(path.into()))
    }

    /// Opens, configures and starts the camera.
    pub fn open(&self, settings: CameraSettings) -> Result<OpenCamera, CommandError> {
        match self {
            Self::Video(device) => open_video(device, settings),
            Self::Genicam(id) => open_genicam(id.as_deref(), settings),
        }
    }
}

/// An open camera.
pub struct OpenCamera {
    /// The camera.
    pub camera: Box<dyn Camera + Send>,
    /// Time at which the camera's stamps were 0, if they are times of exposure; `None` if they are times of arrival.
    pub exposed_since: Option<Instant>,
}

/// Camera settings other than size and rate.
#[derive(Debug, clap::Args)]
pub struct CameraArguments {
    /// Exposure time of the camera (s) [default: the camera's current setting]
    #[arg(long, value_name = "SECONDS", value_parser = parse_exposure)]
    exposure: Option<f64>,
    /// Gain of the camera, in the unit listed by `feeler cameras` [default: the camera's current setting]
    #[arg(long, value_name = "GAIN", value_parser = parse_gain)]
    gain: Option<f64>,
    /// Column and row of the sensor at which the region of interest begins (px; GenICam only) [default: 0,0]
    #[arg(long, value_name = "COLUMN,ROW", value_parser = parse_offset)]
    roi_offset: Option<(usize, usize)>,
    /// Frame trigger: `free`, `software` or an input line, e.g. Line0 (GenICam only) [default: free]
    ///
    /// `free` uses the camera's internal clock, `software` a command at --rate, and a line the signal at that input.
    #[arg(long, value_name = "free|software|LINE")]
    trigger: Option<Trigger>,
}

impl CameraArguments {
    /// Returns the first option that was given.
    pub fn given(&self) -> Option<&'static str> {
        let options = [
            ("--exposure", self.exposure.is_some()),
            ("--gain", self.gain.is_some()),
            ("--roi-offset", self.roi_offset.is_some()),
            ("--trigger", self.trigger.is_some()),
        ];
        let given = options.into_iter().find(|&(_, given)| given);
        given.map(|(option, _)| option)
    }

    /// Returns the settings for images of `size` (px) at `rate` (Hz).
    pub fn settings(&self, size: (usize, usize), rate: f64) -> CameraSettings {
        CameraSettings {
            size,
            rate,
            exposure: self.exposure,
            gain: self.gain,
            offset: self.roi_offset,
            trigger: self.trigger.clone().unwrap_or_default(),
        }
    }
}

fn parse_exposure(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok();
    let seconds = seconds.filter(|seconds| (1e-6..=1e3).contains(seconds));
    seconds.ok_or_else(|| "expected 0.000001 to 1000 s".into())
}

fn parse_gain(text: &str) -> Result<f64, String> {
    let gain = text.parse::<f64>().ok().filter(|gain| gain.is_finite());
    gain.ok_or_else(|| "expected a number".into())
}

fn parse_offset(text: &str) -> Result<(usize, usize), String> {
    let place = |place: &str| place.trim().parse().ok().filter(|place| *place <= 65_535);
    let offset = text.split_once(',');
    offset
        .and_then(|(column, row)| Some((place(column)?, place(row)?)))
        .ok_or_else(|| "expected COLUMN,ROW from 0 to 65535 px each, e.g. 640,480".into())
}

#[cfg(all(feature = "camera", target_os = "linux"))]
fn open_video(device: &Path, settings: CameraSettings) -> Result<OpenCamera, CommandError> {
    use feeler_sources::video::{VideoCamera, VideoConfig};
    let camera = VideoCamera::open(&VideoConfig {
        device: device.to_path_buf(),
        settings,
    })?;
    Ok(OpenCamera {
        exposed_since: Some(camera.opened()),
        camera: Box::new(camera),
    })
}

#[cfg(not(all(feature = "camera", target_os = "linux")))]
fn open_video(device: &Path, _: CameraSettings) -> Result<OpenCamera, CommandError> {
    Err(format!("{}: {}", device.display(), super::cameras::NO_VIDEO).into())
}

#[cfg(all(feature = "genicam", target_os = "linux"))]
fn open_genicam(id: Option<&str>, settings: CameraSettings) -> Result<OpenCamera, CommandError> {
    use feeler_sources::genicam::{GenicamCamera, GenicamConfig};
    let camera = GenicamCamera::open(&GenicamConfig {
        id: id.map(str::to_owned),
        settings,
    })?;
    Ok(OpenCamera {
        exposed_since: Some(camera.opened()),
        camera: Box::new(camera),
    })
}

#[cfg(not(all(feature = "genicam", target_os = "linux")))]
fn open_genicam(id: Option<&str>, _: CameraSettings) -> Result<OpenCamera, CommandError> {
    let id = id.unwrap_or_default();
    Err(format!("genicam:{id}: {}", super::cameras::NO_GENICAM).into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn camera_names_are_distinguished_from_files() {
        let named = |name: &str| CameraName::of(Path::new(name));
        assert_eq!(named("genicam:"), Some(CameraName::Genicam(None)));
        assert_eq!(
            named("genicam:Fake_1"),
            Some(CameraName::Genicam(Some("Fake_1".into())))
        );
        for device in ["/dev/video0", "/dev/v4l/by-id/usb-cam-index0"] {
            assert_eq!(named(device), Some(CameraName::Video(device.into())));
        }
        for file in ["genicam", "images", "/dev/shm/video0", "-"] {
            assert_eq!(named(file), None);
        }
    }
}
