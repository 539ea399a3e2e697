//! The exposure time, by whichever names a camera's controls go.

use super::{VideoConfig, VideoError};
use linuxvideo::Device;

/// Names of the control that sets the exposure time, in units of 100 us.
const EXPOSURE_CONTROLS: [&str; 2] = ["Exposure Time, Absolute", "Exposure (Absolute)"];
/// Names of the control that must be [`MANUAL_EXPOSURE`] for that.
const AUTO_EXPOSURE_CONTROLS: [&str; 2] = ["Auto Exposure", "Exposure, Auto"];
/// `V4L2_EXPOSURE_MANUAL`.
const MANUAL_EXPOSURE: i32 = 1;
/// Exposure time's unit, s.
const EXPOSURE_UNIT: f64 = 1e-4;

/// Sets the exposure time, s.
pub(super) fn set_exposure(config: &VideoConfig, exposure: f64) -> Result<(), VideoError> {
    let refused = |reason: String| VideoError::Exposure {
        device: config.device.clone(),
        exposure,
        reason,
    };
    let set = || -> Result<(), String> {
        let mut device = Device::open(&config.device).map_err(|e| e.to_string())?;
        let controls: Vec<_> = device.controls().filter_map(Result::ok).collect();
        let control = |names: [&str; 2]| controls.iter().find(|c| names.contains(&c.name()));
        let time = control(EXPOSURE_CONTROLS).ok_or("the camera has no such control")?;
        let value = exposure_steps(exposure, time.minimum(), time.maximum())?;
        if let Some(automatic) = control(AUTO_EXPOSURE_CONTROLS) {
            let written = device.write_control_raw(automatic.id(), MANUAL_EXPOSURE);
            written.map_err(|e| e.to_string())?;
        }
        let written = device.write_control_raw(time.id(), value);
        written.map_err(|e| e.to_string())
    };
    set().map_err(refused)
}

/// An exposure time (s) in the control's unit, if it lies within its range.
fn exposure_steps(exposure: f64, low: i32, high: i32) -> Result<i32, String> {
    let steps = (exposure / EXPOSURE_UNIT).round();
    if (f64::from(low)..=f64::from(high)).contains(&steps) {
        return Ok(steps as i32);
    }
    let [low, high] = [low, high].map(|limit| f64::from(limit) * EXPOSURE_UNIT);
    Err(format!("expected {low:.4} to {high:.4} s"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exposure_is_refused_beyond_the_control() {
        assert_eq!(exposure_steps(0.01, 1, 5000), Ok(100));
        assert!(exposure_steps(1.0, 1, 5000).is_err());
        assert!(exposure_steps(f64::NAN, 1, 5000).is_err());
    }
}
