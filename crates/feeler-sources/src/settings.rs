//! How a camera is set, whatever kind it is.

use std::fmt;
use std::str::FromStr;

/// What is asked of a camera.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraSettings {
    /// Columns and rows of the pictures, px.
    pub size: (usize, usize),
    /// Frames per second, Hz; the camera takes the nearest that it can.
    pub rate: f64,
    /// Exposure time, s; as the camera is set if none.
    pub exposure: Option<f64>,
    /// Gain in the camera's own unit, mostly dB; as the camera is set if none.
    pub gain: Option<f64>,
    /// Column and row of the camera's sensor at which pictures begin, px: with their size, the region of interest. As the camera is
    /// set if none.
    pub offset: Option<(usize, usize)>,
    /// What makes the camera take a picture.
    pub trigger: Trigger,
}

impl CameraSettings {
    /// Pictures of `size` px at `rate` Hz, freely running, and else as the camera is set.
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

/// What makes a camera take a picture.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Trigger {
    /// Its own clock.
    #[default]
    Free,
    /// A command for each picture, at the rate that is asked for.
    Software,
    /// A signal at this input of the camera, as in `Line0`.
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

/// Why a text is no trigger.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("expected free, software, or the camera's name of an input, as in Line0")]
pub struct TriggerError;

impl FromStr for Trigger {
    type Err = TriggerError;

    fn from_str(text: &str) -> Result<Self, TriggerError> {
        match text {
            "free" => Ok(Self::Free),
            "software" => Ok(Self::Software),
            line if !line.is_empty() && line.chars().all(|c| c.is_ascii_alphanumeric()) => {
                Ok(Self::Line(line.into()))
            }
            _ => Err(TriggerError),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triggers_are_read_as_they_are_written() {
        for text in ["free", "software", "Line0"] {
            assert_eq!(text.parse::<Trigger>().unwrap().to_string(), text);
        }
        for text in ["", "Line 0", "../Line0"] {
            assert_eq!(text.parse::<Trigger>(), Err(TriggerError));
        }
    }
}
