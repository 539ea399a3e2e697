//! Cameras on the command line: how they are named and set.

use super::CommandError;
use feeler::sensor::camera::Camera;
use feeler_sources::settings::{CameraSettings, Trigger};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What cameras are called, for messages.
pub const NAMES: &str = "/dev/videoN, or genicam:ID as `feeler cameras` lists them";

/// Which camera.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum CameraName {
    /// A Video4Linux device.
    Video(PathBuf),
    /// The GenICam camera with this id, serial number or address; the first one if none.
    Genicam(Option<String>),
}

impl CameraName {
    /// The camera that is named so, if it is the name of one. `/dev/shm` holds files.
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

    /// Opens, sets and starts it.
    pub fn open(&self, settings: CameraSettings) -> Result<OpenCamera, CommandError> {
        match self {
            Self::Video(device) => open_video(device, settings),
            Self::Genicam(id) => open_genicam(id.as_deref(), settings),
        }
    }
}

/// A camera that takes pictures.
pub struct OpenCamera {
    /// The camera.
    pub camera: Box<dyn Camera + Send>,
    /// When its stamps were 0, if they are times of exposure; those of other cameras are times of arrival.
    pub exposed_since: Option<Instant>,
}

/// How a camera is set, besides size and rate.
#[derive(Debug, clap::Args)]
pub struct CameraArguments {
    /// Exposure time of the camera, s [default: as the camera is set]
    #[arg(long, value_name = "SECONDS", value_parser = parse_exposure)]
    exposure: Option<f64>,
    /// Gain of the camera, in its own unit, as `feeler cameras` lists it [default: as the camera is set]
    #[arg(long, value_name = "GAIN", value_parser = parse_gain)]
    gain: Option<f64>,
    /// Column and row of the camera's sensor at which the pictures begin, px: with their size, the region of interest
    /// (GenICam cameras) [default: 0,0]
    #[arg(long, value_name = "COLUMN,ROW", value_parser = parse_offset)]
    roi_offset: Option<(usize, usize)>,
    /// What makes the camera take a picture: free, its own clock; software, a command at --rate; or a signal at one of its
    /// inputs, as in Line0 (GenICam cameras) [default: free]
    #[arg(long, value_name = "free|software|LINE")]
    trigger: Option<Trigger>,
}

impl CameraArguments {
    /// The first option that was given.
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

    /// What is asked of a camera for pictures of `size` px at `rate` Hz.
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
        .ok_or_else(|| "expected COLUMN,ROW of 0 to 65535 px each, as in 640,480".into())
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
    fn cameras_are_told_from_files() {
        let named = |name: &str| CameraName::of(Path::new(name));
        assert_eq!(named("genicam:"), Some(CameraName::Genicam(None)));
        assert_eq!(
            named("genicam:Fake_1"),
            Some(CameraName::Genicam(Some("Fake_1".into())))
        );
        for device in ["/dev/video0", "/dev/v4l/by-id/usb-cam-index0"] {
            assert_eq!(named(device), Some(CameraName::Video(device.into())));
        }
        for file in ["genicam", "pictures", "/dev/shm/video0", "-"] {
            assert_eq!(named(file), None);
        }
    }
}
