//! Cameras by name.

use feeler::sensor::image::Camera;
use feeler_console::CommandError;
use feeler_sources::{CameraSettings, Trigger};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Expected format of camera names, for error messages.
pub const NAMES: &str = "/dev/videoN, or genicam:ID as listed by `feeler cameras`";

/// Message of a program built without Video4Linux cameras.
pub const NO_VIDEO: &str =
    "this program was built without Video4Linux cameras; build it on Linux with --features camera";
/// Message of a program built without GenICam cameras.
pub const NO_GENICAM: &str =
    "this program was built without GenICam cameras; build it on Linux with --features genicam";

/// Name of a camera.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum CameraName {
    /// A Video4Linux device.
    Video(PathBuf),
    /// GenICam camera with this id, serial number or address, or the first one found if `None`.
    Genicam(Option<String>),
}

impl CameraName {
    /// Parses `path` as the name of a camera; `None` if it is not one. Other files in `/dev`, such as those in `/dev/shm`, are files.
    pub fn parse(path: &Path) -> Option<Self> {
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
    ///
    /// # Errors
    /// If it cannot be opened or refuses a setting.
    pub fn open(&self, settings: CameraSettings) -> Result<OpenCamera, CommandError> {
        match self {
            Self::Video(device) => open_video(device, settings),
            Self::Genicam(id) => open_genicam(id.as_deref(), settings),
        }
    }
}

/// A running camera.
pub struct OpenCamera {
    /// The camera.
    pub camera: Box<dyn Camera + Send>,
    /// Instant at which its stamps were 0, or `None` if its stamps are arrival times rather than exposure times.
    pub exposed_since: Option<Instant>,
}

/// Settings of a camera besides size and rate.
#[derive(Debug, Clone, Default)]
pub struct CameraOptions {
    /// Exposure time (s), or `None` to keep the camera's setting.
    pub exposure: Option<f64>,
    /// Gain in the camera's unit, or `None` to keep the camera's setting.
    pub gain: Option<f64>,
    /// Column and row of the camera's sensor at which the images begin (px), or `None` for the origin.
    pub roi_offset: Option<(usize, usize)>,
    /// Trigger, or `None` for the camera's internal clock.
    pub trigger: Option<Trigger>,
}

impl CameraOptions {
    /// Returns the name of the first given option, if any.
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

    /// Settings for images of `size` (columns, rows) at `rate` Hz.
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
    Err(format!("{}: {}", device.display(), NO_VIDEO).into())
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
    Err(format!("genicam:{id}: {}", NO_GENICAM).into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cameras_are_distinguished_from_files() {
        let named = |name: &str| CameraName::parse(Path::new(name));
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
