//! Lists the cameras that respond, with their capabilities.

use super::aravis::{Aravis, Quantity};
use super::{FAKE, GenicamError};

/// Minimum and maximum value.
pub type Range = [f64; 2];

/// A camera that responds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GenicamDevice {
    /// Id, as in `genicam:ID`.
    pub id: String,
    /// Vendor.
    pub vendor: String,
    /// Model.
    pub model: String,
    /// Serial number.
    pub serial: String,
    /// Protocol: `GigEVision`, `USB3Vision`, or `Fake` if Aravis simulates the camera.
    pub protocol: String,
    /// Network address; empty or 0.0.0.0 if the camera has none.
    pub address: String,
}

/// A camera that responds, and its capabilities.
#[derive(Debug, Clone, PartialEq)]
pub struct GenicamInfo {
    /// Identity of the camera.
    pub device: GenicamDevice,
    /// Capabilities, or the reason why they cannot be read (such as another program using the camera).
    pub abilities: Result<Abilities, String>,
}

/// Capabilities of a camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Abilities {
    /// Columns and rows of the sensor, px.
    pub sensor_size: [i32; 2],
    /// Column, row, width and height of the current region, px.
    pub region: [i32; 4],
    /// Names of the available pixel formats.
    pub pixel_formats: Vec<String>,
    /// Range of exposure times, s; `None` if they cannot be set.
    pub exposure: Option<Range>,
    /// Range of gains, in the camera's unit; `None` if they cannot be set.
    pub gain: Option<Range>,
    /// Range of frame rates, Hz; `None` if they cannot be set.
    pub rate: Option<Range>,
    /// Names of the available trigger sources.
    pub triggers: Vec<String>,
}

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
    let device = aravis.open(Some(id))?;
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
