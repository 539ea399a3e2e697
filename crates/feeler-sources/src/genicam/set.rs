//! Applies settings to a camera and reads them back.

use super::aravis::device::{Device, Quantity};
use super::error::GenicamError;
use super::pixels::Pixels;
use crate::settings::{CameraSettings, Trigger};

/// Name of the trigger source for software triggers.
const SOFTWARE: &str = "Software";
/// Microseconds, the unit of exposure times, per second.
const MICROSECONDS: f64 = 1e6;

/// Applies `settings` to the camera `device` and returns the chosen pixel format. `name` is the camera's name in
/// errors.
pub(super) fn apply(
    device: &Device,
    name: &str,
    settings: &CameraSettings,
) -> Result<Pixels, GenicamError> {
    let refused = |what: String| {
        let camera = name.to_owned();
        move |reason| GenicamError::Setting {
            camera,
            what,
            reason,
        }
    };
    let pixels = pixel_format(device).map_err(refused("images".into()))?;
    let (width, height) = settings.size;
    let what = match settings.offset {
        Some((x, y)) => format!("a region of {width}x{height} px from column {x}, row {y}"),
        None => format!("images of {width}x{height} px"),
    };
    region(device, settings).map_err(refused(what))?;
    if let Some(exposure) = settings.exposure {
        let set = within(device, Quantity::Exposure, exposure, MICROSECONDS, " s");
        set.map_err(refused(format!("an exposure time of {exposure} s")))?;
    }
    if let Some(gain) = settings.gain {
        within(device, Quantity::Gain, gain, 1.0, "")
            .map_err(refused(format!("a gain of {gain}")))?;
    }
    let what = format!("trigger {}", settings.trigger);
    trigger(device, settings).map_err(refused(what))?;
    Ok(pixels)
}

/// Sets the preferred pixel format among the available ones.
fn pixel_format(device: &Device) -> Result<Pixels, String> {
    let offered = device.pixel_formats()?;
    let known = |pixels: &Pixels| offered.iter().any(|name| name == pixels.name());
    let Some(pixels) = Pixels::ALL.into_iter().find(known) else {
        let expected = Pixels::ALL.map(Pixels::name).join(", ");
        let offered = offered.join(", ");
        return Err(format!(
            "expected one of {expected}; the camera has {offered}"
        ));
    };
    device.set_pixel_format(pixels.name())?;
    Ok(pixels)
}

fn region(device: &Device, settings: &CameraSettings) -> Result<(), String> {
    let number = |value: usize| i32::try_from(value).map_err(|e| e.to_string());
    let (width, height) = (number(settings.size.0)?, number(settings.size.1)?);
    let [columns, rows] = device.sensor_size()?;
    let bounds = device.size_bounds()?;
    let offset = match settings.offset {
        Some((x, y)) => Some((number(x)?, number(y)?)),
        None => None,
    };
    let (x, y) = offset.unwrap_or((0, 0));
    // An offset set earlier may leave no room for this region.
    let movable = device.has_offset();
    if movable {
        let [_, _, width, height] = device.region()?;
        device.set_region([0, 0, width, height])?;
    }
    let [within_columns, within_rows] = bounds;
    let fits = |[low, high]: [i32; 2], size: i32| (low..=high).contains(&size);
    if i64::from(x) + i64::from(width) > i64::from(columns)
        || i64::from(y) + i64::from(height) > i64::from(rows)
        || !fits([within_columns[0], columns], width)
        || !fits([within_rows[0], rows], height)
    {
        return Err(format!(
            "expected one within the sensor's {columns}x{rows} px"
        ));
    }
    if !movable && (x, y) != (0, 0) {
        return Err("the camera's region cannot be moved".into());
    }
    let place = if movable { [x, y] } else { [-1, -1] };
    device.set_region([place[0], place[1], width, height])?;
    let [column, row, columns, rows] = device.region()?;
    if [columns, rows] != [width, height] || (movable && [column, row] != [x, y]) {
        return Err(format!(
            "the camera uses {columns}x{rows} px from column {column}, row {row} instead; use multiples of its step sizes"
        ));
    }
    Ok(())
}

/// Sets a quantity to `value` if it is within the camera's range. `units` is the number of camera units per unit of
/// `value`.
fn within(
    device: &Device,
    quantity: Quantity,
    value: f64,
    units: f64,
    suffix: &str,
) -> Result<(), String> {
    let bounds = device.bounds(quantity)?.ok_or("the camera has none")?;
    let asked = value * units;
    let [low, high] = bounds;
    if !(low..=high).contains(&asked) {
        let [low, high] = bounds.map(|bound| bound / units);
        return Err(format!("expected {low} to {high}{suffix}"));
    }
    device.set(quantity, asked)
}

fn trigger(device: &Device, settings: &CameraSettings) -> Result<(), String> {
    let source = match &settings.trigger {
        Trigger::Free => {
            device.clear_triggers()?;
            return rate(device, settings.rate);
        }
        Trigger::Software => SOFTWARE,
        Trigger::Line(line) => line,
    };
    let sources = device.trigger_sources()?;
    if !sources.iter().any(|known| known == source) {
        let sources = sources.join(", ");
        return Err(format!(
            "expected one of the camera's trigger sources: {sources}"
        ));
    }
    device.set_trigger(source)
}

/// Sets the frame rate in the camera's range that is nearest to `rate` (Hz).
fn rate(device: &Device, rate: f64) -> Result<(), String> {
    match device.bounds(Quantity::FrameRate)? {
        // The bounds may be reversed because of a long exposure.
        Some([low, high]) => device.set(Quantity::FrameRate, rate.min(high).max(low)),
        None => Ok(()),
    }
}
