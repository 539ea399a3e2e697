//! Description of a GenICam camera.

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
    /// Width and height of the sensor, px.
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
