//! Settings of a camera, independent of its interface.

use std::fmt;
use std::str::FromStr;

/// Settings of a camera.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraSettings {
    /// Width and height of the images, px.
    pub size: (usize, usize),
    /// Frame rate, Hz; the camera uses the nearest available one.
    pub rate: f64,
    /// Exposure time, s; unchanged if `None`.
    pub exposure: Option<f64>,
    /// Gain in the camera's unit, mostly dB; unchanged if `None`.
    pub gain: Option<f64>,
    /// Column and row of the sensor at which images start, px; together with the size, this is the region of
    /// interest. Unchanged if `None`.
    pub offset: Option<(usize, usize)>,
    /// Trigger of each image.
    pub trigger: Trigger,
}

impl CameraSettings {
    /// Images of `size` px at `rate` Hz, free-running; all other settings of the camera are unchanged.
    pub fn new(size: (usize, usize), rate: f64) -> Self {
        Self {
            size,
            rate,
            exposure: None,
            gain: None,
            offset: None,
            trigger: Trigger::Free,
        }
    }
}

/// Trigger of a camera's images.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Trigger {
    /// The camera's internal clock.
    #[default]
    Free,
    /// A command for each image, at the configured rate.
    Software,
    /// A signal at this input of the camera, such as `Line0`.
    Line(String),
}

impl fmt::Display for Trigger {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Free => "free",
            Self::Software => "software",
            Self::Line(line) => line,
        })
    }
}

/// Error of parsing a [`Trigger`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("expected free, software, or the name of a camera input such as Line0")]
pub struct ParseTriggerError;

impl FromStr for Trigger {
    type Err = ParseTriggerError;

    fn from_str(text: &str) -> Result<Self, ParseTriggerError> {
        match text {
            "free" => Ok(Self::Free),
            "software" => Ok(Self::Software),
            line if !line.is_empty() && line.chars().all(|c| c.is_ascii_alphanumeric()) => {
                Ok(Self::Line(line.into()))
            }
            _ => Err(ParseTriggerError),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triggers_round_trip() {
        for text in ["free", "software", "Line0"] {
            assert_eq!(text.parse::<Trigger>().unwrap().to_string(), text);
        }
        for text in ["", "Line 0", "../Line0"] {
            assert_eq!(text.parse::<Trigger>(), Err(ParseTriggerError));
        }
    }
}
