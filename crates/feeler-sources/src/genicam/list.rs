//! Lists the cameras that respond, with their capabilities.

use super::aravis::device::{Device, Quantity};
use super::aravis::{Aravis, FAKE};
use super::error::GenicamError;
use super::info::{Abilities, GenicamDevice, GenicamInfo};

/// Lists all cameras that respond within a second, including those that Aravis simulates if `simulated`.
///
/// # Errors
/// If Aravis cannot be loaded.
pub fn list(simulated: bool) -> Result<Vec<GenicamInfo>, GenicamError> {
    let aravis = Aravis::load().map_err(|reason| GenicamError::Library { reason })?;
    if simulated {
        aravis.enable_fake();
    }
    let devices = aravis.devices().into_iter();
    // A simulated camera may be enabled from an earlier call.
    let devices = devices.filter(|device| simulated || !device.id.starts_with(FAKE));
    let info = |device: GenicamDevice| GenicamInfo {
        abilities: abilities(aravis, &device.id),
        device,
    };
    Ok(devices.map(info).collect())
}

/// Ids of all cameras that respond, separated by commas.
pub(super) fn ids(aravis: &Aravis) -> String {
    let ids: Vec<String> = aravis
        .devices()
        .into_iter()
        .map(|device| device.id)
        .collect();
    match ids.is_empty() {
        true => "none".into(),
        false => ids.join(", "),
    }
}

fn abilities(aravis: &'static Aravis, id: &str) -> Result<Abilities, String> {
    let device = Device::open(aravis, Some(id))?;
    let exposure = device.bounds(Quantity::Exposure)?;
    Ok(Abilities {
        sensor_size: device.sensor_size()?,
        region: device.region()?,
        pixel_formats: device.pixel_formats()?,
        exposure: exposure.map(|range| range.map(|microseconds| microseconds / 1e6)),
        gain: device.bounds(Quantity::Gain)?,
        rate: device.bounds(Quantity::FrameRate)?,
        // A camera without triggers has no list of sources.
        triggers: device.trigger_sources().unwrap_or_default(),
    })
}
