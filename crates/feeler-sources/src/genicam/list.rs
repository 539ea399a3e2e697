//! Which cameras answer, and what they can do.

use super::FAKE;
use super::GenicamError;
use super::aravis::{Aravis, Quantity};

/// Least and largest value.
pub type Range = [f64; 2];

/// A camera that answers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GenicamDevice {
    /// What it is called by, as in `genicam:ID`.
    pub id: String,
    /// Who made it.
    pub vendor: String,
    /// What the maker calls it.
    pub model: String,
    /// Its serial number.
    pub serial: String,
    /// How it is connected: `GigEVision`, `USB3Vision`, or `Fake` where Aravis simulates it.
    pub protocol: String,
    /// Its address in the network; empty or 0.0.0.0 without one.
    pub address: String,
}

/// A camera that answers, and what it can do.
#[derive(Debug, Clone, PartialEq)]
pub struct GenicamInfo {
    /// Which one it is.
    pub device: GenicamDevice,
    /// What it can do; why that is not known (it is in use by another program).
    pub abilities: Result<Abilities, String>,
}

/// What a camera can do.
#[derive(Debug, Clone, PartialEq)]
pub struct Abilities {
    /// Columns and rows of its sensor, px.
    pub sensor_size: [i32; 2],
    /// Column, row, columns and rows of the region that is read now, px.
    pub region: [i32; 4],
    /// Names of its pixel formats.
    pub pixel_formats: Vec<String>,
    /// Exposure times, s; none if they cannot be set.
    pub exposure: Option<Range>,
    /// Gains, in the camera's unit; none if they cannot be set.
    pub gain: Option<Range>,
    /// Frame rates, Hz; none if they cannot be set.
    pub rate: Option<Range>,
    /// What can trigger a picture.
    pub triggers: Vec<String>,
}

/// All cameras that answer within a second; with those that Aravis simulates if `simulated`.
///
/// # Errors
/// When Aravis is not there.
pub fn list(simulated: bool) -> Result<Vec<GenicamInfo>, GenicamError> {
    let aravis = Aravis::load().map_err(|reason| GenicamError::Library { reason })?;
    if simulated {
        aravis.enable_fake();
    }
    let devices = aravis.devices().into_iter();
    // One that is simulated may be known from before.
    let devices = devices.filter(|device| simulated || !device.id.starts_with(FAKE));
    let info = |device: GenicamDevice| GenicamInfo {
        abilities: abilities(aravis, &device.id),
        device,
    };
    Ok(devices.map(info).collect())
}

/// The ids of all cameras that answer.
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
        // A camera that cannot be triggered has no list of sources.
        triggers: device.trigger_sources().unwrap_or_default(),
    })
}
