//! The messages `feeler_msgs/TactileArray` and `feeler_msgs/TactileChannel`.

use crate::ros::{Header, header_schema, nested, quaternion_schema, xyz_schema};
use crate::wire::{Message, Quaternion, Vector3};
use serde::{Deserialize, Serialize};

/// Bit of [`TactileArray::contact`]: the element touches an object.
pub const CONTACT: u8 = 1;
/// Bit of [`TactileArray::contact`]: the element slips.
pub const SLIP: u8 = 2;
/// Bit of [`TactileArray::contact`]: the element must not be loaded further.
pub const OVERLOAD: u8 = 4;

/// Bit of [`TactileChannel::status`]: the value must not be used.
pub const INVALID: u8 = 1;
/// Bit of [`TactileChannel::status`]: a component is at the end of its range.
pub const SATURATED: u8 = 2;
/// Bit of [`TactileChannel::status`]: the value is older than the header's time.
pub const STALE: u8 = 4;

/// [`TactileChannel::axes`] of vectors in the frame of each element.
pub const ELEMENT_AXES: u8 = 0;
/// [`TactileChannel::axes`] of vectors in the frame of the header.
pub const SENSOR_AXES: u8 = 1;

/// [`TactileChannel::calibration`] of values without a known relation to a unit.
pub const UNCALIBRATED: u8 = 0;
/// [`TactileChannel::calibration`] of values converted with constants of the model.
pub const NOMINAL: u8 = 1;
/// [`TactileChannel::calibration`] of values converted with a calibration of this sensor.
pub const CALIBRATED: u8 = 2;

/// Names of common channels.
pub mod names {
    /// Force in N, three components.
    pub const FORCE: &str = "force";
    /// Displacement of the element's tip in m, three components.
    pub const DISPLACEMENT: &str = "displacement";
    /// Pressure in Pa, one component.
    pub const PRESSURE: &str = "pressure";
    /// Magnitude of the rate of change of the tangential force in N/s, one component.
    pub const SHEAR_RATE: &str = "shear_rate";
    /// Magnetic flux density in T, three components.
    pub const FLUX_DENSITY: &str = "flux_density";
    /// Temperature in K, one component.
    pub const TEMPERATURE: &str = "temperature";
    /// Counts of an A/D converter or a camera.
    pub const RAW: &str = "raw";
}

/// One sample of a tactile sensor. Lists per element have as many entries as `positions`, or none if they are unknown.
/// Forces act on the sensor and are exerted by the touched object.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct TactileArray {
    /// Time of measurement, and frame of positions and orientations.
    pub header: Header,
    /// Number of the sample.
    pub sequence: u64,
    /// Unique name or serial number of the sensor.
    pub sensor: String,
    /// Manufacturer and model, or empty if unknown.
    pub model: String,
    /// Principle of measurement, or empty if unknown.
    pub principle: String,
    /// `true` if the values are not from a physical sensor.
    pub simulated: bool,
    /// Nominal rate of samples (Hz), or NaN if unknown or irregular.
    pub rate: f64,
    /// Position of each unloaded element (m).
    pub positions: Vec<Vector3>,
    /// Orientation of each element's frame: z is the outward normal, x and y are tangential.
    pub orientations: Vec<Quaternion>,
    /// Sensitive area of each element (m²).
    pub areas: Vec<f64>,
    /// Measured quantities.
    pub channels: Vec<TactileChannel>,
    /// [`CONTACT`], [`SLIP`] and [`OVERLOAD`] of each element, or empty if not determined.
    pub contact: Vec<u8>,
    /// Compression above which an element touches (N), or NaN if unknown.
    pub contact_threshold: f64,
    /// Rate of change of the tangential force above which an element slips (N/s), or NaN if unknown.
    pub slip_threshold: f64,
    /// Compression above which an element is overloaded (N), or NaN if unknown.
    pub overload_threshold: f64,
}

/// One quantity of all elements of a tactile sensor.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct TactileChannel {
    /// Name of the quantity, such as one of [`names`].
    pub name: String,
    /// Unit in UCUM notation.
    pub unit: String,
    /// Axes of vectors: [`ELEMENT_AXES`] or [`SENSOR_AXES`].
    pub axes: u8,
    /// Number of values per element: 1 or 3.
    pub components: u8,
    /// [`UNCALIBRATED`], [`NOMINAL`] or [`CALIBRATED`].
    pub calibration: u8,
    /// Identifier of the calibration, or empty if unknown.
    pub calibration_id: String,
    /// Lower end of the range of each component, or NaN if unknown.
    pub minimum: f64,
    /// Upper end of the range of each component, or NaN if unknown.
    pub maximum: f64,
    /// Values, element by element; NaN if unknown.
    pub values: Vec<f64>,
    /// Variance of each value, or empty if unknown.
    pub variances: Vec<f64>,
    /// [`INVALID`], [`SATURATED`] and [`STALE`] of each element, or empty if all values are valid.
    pub status: Vec<u8>,
}

impl Message for TactileArray {
    const SCHEMA_NAME: &'static str = "feeler_msgs/msg/TactileArray";
    const SCHEMA: &'static str = concat!(
        include_str!("../../msg/feeler_msgs/TactileArray.msg"),
        header_schema!(),
        xyz_schema!("geometry_msgs/Point"),
        quaternion_schema!(),
        nested!("feeler_msgs/TactileChannel"),
        include_str!("../../msg/feeler_msgs/TactileChannel.msg"),
    );
}

/// Joins the bits that are set.
pub(super) fn joined(bits: &[(bool, u8)]) -> u8 {
    let set = bits.iter().filter(|(is_set, _)| *is_set);
    set.fold(0, |all, (_, bit)| all | bit)
}
