//! Forces from `sensor_msgs/PointCloud2`, as `feeler ros2` publishes them: each element's tip `x`, `y`, `z`, m, and the force on it by what it
//! touches, `fx`, `fy`, `fz`, N, both in the fingertip's frame `T`; where there is a field `valid`, a force counts if that is not 0.

use feeler::sensor::fingertip::SensingElement;
use feeler::sensor::forces::NO_FORCE;
use feeler_record::ros::{PointCloud2, PointField};
use glam::DVec3;

/// A number of 64 bits, as [`PointField::datatype`] has it.
const FLOAT64: u8 = 8;

/// Why a cloud holds no forces.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CloudError {
    /// It has another number of points.
    #[error("a cloud of {expected} points expected, found {height} rows of {width}")]
    Points {
        /// Elements of the fingertip.
        expected: usize,
        /// Its rows.
        height: u32,
        /// Points of a row.
        width: u32,
    },
    /// Its numbers have their most significant bytes first.
    #[error("a cloud of little-endian numbers expected, found big-endian ones")]
    BigEndian,
    /// A field is not there, or of another type, or stands beyond its point.
    #[error("a cloud with a field {0} of 32 or 64 bits within each point expected, found none")]
    Field(&'static str),
    /// It has too few bytes.
    #[error("a cloud of {expected} bytes expected, found {actual}")]
    Bytes {
        /// As its sizes tell.
        expected: usize,
        /// What there are.
        actual: usize,
    },
}

/// Fills `forces` with what the elements of a fingertip feel, each in its own frame as in a
/// [`TactileFrame`](feeler::sensor::forces::TactileFrame).
///
/// # Errors
/// When the cloud has other points or fields: then `forces` are of no use.
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
    let step = cloud.point_step as usize;
    let number = |name| number(cloud, name);
    let tip = [number("x")?, number("y")?, number("z")?];
    let force = [number("fx")?, number("fy")?, number("fz")?];
    let valid = cloud.fields.iter().find(|field| field.name == "valid");
    let valid = valid.map(|field| field.offset as usize);
    let expected = step.saturating_mul(forces.len());
    if step == 0 || cloud.data.len() < expected {
        let actual = cloud.data.len();
        return Err(CloudError::Bytes { expected, actual });
    }
    for (out, point) in forces.iter_mut().zip(cloud.data.chunks_exact(step)) {
        let vector =
            |places: &[Number; 3]| DVec3::from_array(places.each_ref().map(|n| n.read(point)));
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

/// Where a number stands in a point, and whether it has 64 bits.
#[derive(Clone, Copy)]
struct Number {
    offset: usize,
    is_double: bool,
}

impl Number {
    fn read(self, point: &[u8]) -> f64 {
        let bytes = point.get(self.offset..).unwrap_or_default();
        match self.is_double {
            true => bytes
                .first_chunk()
                .map_or(f64::NAN, |b| f64::from_le_bytes(*b)),
            false => bytes
                .first_chunk()
                .map_or(f64::NAN, |b| f32::from_le_bytes(*b).into()),
        }
    }
}

/// The field `name` of a cloud.
fn number(cloud: &PointCloud2, name: &'static str) -> Result<Number, CloudError> {
    let field = cloud.fields.iter().find(|field| field.name == name);
    let field = field.ok_or(CloudError::Field(name))?;
    let bytes: u32 = match field.datatype {
        PointField::FLOAT32 => 4,
        FLOAT64 => 8,
        _ => return Err(CloudError::Field(name)),
    };
    let end = field.offset.checked_add(bytes);
    match end.is_some_and(|end| end <= cloud.point_step) {
        true => Ok(Number {
            offset: field.offset as usize,
            is_double: bytes == 8,
        }),
        false => Err(CloudError::Field(name)),
    }
}
