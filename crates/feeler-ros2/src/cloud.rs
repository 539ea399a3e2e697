//! Reads forces from `sensor_msgs/PointCloud2`, in the layout that `feeler ros2` publishes.
//!
//! Each point contains the position of an element's tip `x`, `y`, `z` (m) and the force on the element by the touched
//! object `fx`, `fy`, `fz` (N), both in the fingertip's frame `T`. If the cloud has a field `valid`, a force is unknown
//! if its value is 0.

use feeler::sensor::fingertip::SensingElement;
use feeler::sensor::forces::NO_FORCE;
use feeler_record::ros::{FloatField, PointCloud2};
use glam::DVec3;

/// Error when reading forces from a cloud.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CloudError {
    /// The number of points differs from the number of elements.
    #[error("expected a cloud of {expected} points, got {height} rows of {width}")]
    Points {
        /// Number of elements of the fingertip.
        expected: usize,
        /// Number of rows.
        height: u32,
        /// Number of points per row.
        width: u32,
    },
    /// The cloud contains big-endian numbers.
    #[error("expected a cloud of little-endian numbers, got big-endian ones")]
    BigEndian,
    /// A field is missing, is not a floating-point number, or extends beyond its point.
    #[error("expected a cloud with a 32- or 64-bit float field {0} within each point, found none")]
    Field(&'static str),
    /// The cloud contains too few bytes.
    #[error("expected a cloud of {expected} bytes, got {actual}")]
    Bytes {
        /// Number of bytes of all points and of the padding between rows.
        expected: usize,
        /// Actual number of bytes.
        actual: usize,
    },
}

/// Reads the force on each element of a fingertip from `cloud` to `forces`, in the element's frame as in a
/// [`TactileFrame`](feeler::sensor::forces::TactileFrame). The cloud must contain one point per element, in order.
///
/// # Errors
/// If the cloud does not have the expected points and fields.
pub fn read_forces(cloud: &PointCloud2, forces: &mut [DVec3]) -> Result<(), CloudError> {
    let (height, width) = (cloud.height, cloud.width);
    if u64::from(height) * u64::from(width) != forces.len() as u64 {
        let expected = forces.len();
        return Err(CloudError::Points {
            expected,
            height,
            width,
        });
    }
    if cloud.is_bigendian {
        return Err(CloudError::BigEndian);
    }
    let number = |name| cloud.float_field(name).ok_or(CloudError::Field(name));
    let tip = [number("x")?, number("y")?, number("z")?];
    let force = [number("fx")?, number("fy")?, number("fz")?];
    let valid = cloud.fields.iter().find(|field| field.name == "valid");
    let valid = valid.map(|field| field.offset as usize);
    let points = cloud
        .points()
        .map_err(|(expected, actual)| CloudError::Bytes { expected, actual })?;
    for (out, point) in forces.iter_mut().zip(points) {
        let vector =
            |places: &[FloatField; 3]| DVec3::from_array(places.each_ref().map(|n| n.read(point)));
        let is_valid = valid.is_none_or(|at| point.get(at).is_some_and(|byte| *byte != 0));
        let element = SensingElement::facing(vector(&tip).normalize_or(DVec3::X));
        *out = match is_valid {
            true => {
                let local = element.rotation.transpose() * vector(&force);
                local.with_z(-local.z)
            }
            false => NO_FORCE,
        };
    }
    Ok(())
}
