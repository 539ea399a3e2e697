//! Sets exposure time and gain; drivers differ in the names of these controls.

use super::{VideoConfig, VideoError};
use linuxvideo::Device;

/// Names of the control for the exposure time, in units of 100 us.
const EXPOSURE: [&str; 2] = ["Exposure Time, Absolute", "Exposure (Absolute)"];
/// Names of the control that must first be set to [`MANUAL_EXPOSURE`].
const AUTO_EXPOSURE: [&str; 2] = ["Auto Exposure", "Exposure, Auto"];
/// `V4L2_EXPOSURE_MANUAL`.
const MANUAL_EXPOSURE: i32 = 1;
/// Unit of the exposure time, s.
const EXPOSURE_UNIT: f64 = 1e-4;
/// Possible names of the control for the gain (in the driver's unit).
const GAIN: [&str; 2] = ["Gain", "Analogue Gain"];
/// Possible names of the control that must be off before the gain is set.
const AUTO_GAIN: [&str; 2] = ["Gain, Automatic", "Gain, Auto"];

/// Sets exposure time and gain from `config`.
pub(super) fn set_controls(config: &VideoConfig) -> Result<(), VideoError> {
    let refused = |what: String| {
        let device = config.device.clone();
        move |reason| VideoError::Setting {
            device,
            what,
            reason,
        }
    };
    if let Some(exposure) = config.settings.exposure {
        let steps = |low, high| exposure_steps(exposure, low, high);
        set(config, EXPOSURE, AUTO_EXPOSURE, MANUAL_EXPOSURE, steps)
            .map_err(refused(format!("an exposure time of {exposure} s")))?;
    }
    if let Some(gain) = config.settings.gain {
        let steps = |low, high| gain_steps(gain, low, high);
        set(config, GAIN, AUTO_GAIN, 0, steps).map_err(refused(format!("a gain of {gain}")))?;
    }
    Ok(())
}

/// Sets the control that has one of the `names` after setting the `automatic` control to manual. `value` computes the
/// value from the control's minimum and maximum.
fn set(
    config: &VideoConfig,
    names: [&str; 2],
    automatic: [&str; 2],
    manual: i32,
    value: impl Fn(i32, i32) -> Result<i32, String>,
) -> Result<(), String> {
    let mut device = Device::open(&config.device).map_err(|e| e.to_string())?;
    let controls: Vec<_> = device.controls().filter_map(Result::ok).collect();
    let control = |names: [&str; 2]| controls.iter().find(|c| names.contains(&c.name()));
    let own = control(names).ok_or("the camera has no such control")?;
    let value = value(own.minimum(), own.maximum())?;
    if let Some(automatic) = control(automatic) {
        let written = device.write_control_raw(automatic.id(), manual);
        written.map_err(|e| e.to_string())?;
    }
    let written = device.write_control_raw(own.id(), value);
    written.map_err(|e| e.to_string())
}

/// Converts an exposure time (s) to the control's unit and checks its range.
fn exposure_steps(exposure: f64, low: i32, high: i32) -> Result<i32, String> {
    let steps = (exposure / EXPOSURE_UNIT).round();
    if (f64::from(low)..=f64::from(high)).contains(&steps) {
        return Ok(steps as i32);
    }
    let [low, high] = [low, high].map(|limit| f64::from(limit) * EXPOSURE_UNIT);
    Err(format!("expected {low:.4} to {high:.4} s"))
}

/// Converts a gain to the control's unit and checks its range.
fn gain_steps(gain: f64, low: i32, high: i32) -> Result<i32, String> {
    if gain.fract() == 0.0 && (f64::from(low)..=f64::from(high)).contains(&gain) {
        return Ok(gain as i32);
    }
    Err(format!(
        "expected an integer from {low} to {high} (driver's unit)"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_outside_the_control_s_range_are_refused() {
        assert_eq!(exposure_steps(0.01, 1, 5000), Ok(100));
        assert!(exposure_steps(1.0, 1, 5000).is_err());
        assert!(exposure_steps(f64::NAN, 1, 5000).is_err());
        assert_eq!(gain_steps(12.0, 0, 100), Ok(12));
        for gain in [-1.0, 101.0, 0.5, f64::NAN] {
            assert!(gain_steps(gain, 0, 100).is_err());
        }
    }
}
