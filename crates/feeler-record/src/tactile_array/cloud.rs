//! Conversion from and to `sensor_msgs/PointCloud2`.

use super::ArrayError;
use super::message::{
    CONTACT, INVALID, SATURATED, SLIP, TactileArray, TactileChannel, joined, names,
};
use crate::ros::{FloatField, PointCloud2, fields};
use feeler::sensor::fingertip::SensingElement;
use glam::{DQuat, DVec3};

/// 32-bit numbers of a point: position (m), force on the element by the object (N), and orientation of the element.
const NUMBERS: [&str; 10] = ["x", "y", "z", "fx", "fy", "fz", "qx", "qy", "qz", "qw"];
/// Bytes of a point that are 0 or 1.
const FLAGS: [&str; 4] = ["slip", "valid", "contact", "saturated"];
/// Size of a point in bytes.
const POINT: usize = 4 * NUMBERS.len() + FLAGS.len();

/// Converts an array to a cloud with a point per element, in the header's frame: `x y z` (m), `fx fy fz` (N), `qx qy qz
/// qw`, and `slip valid contact saturated` (0 or 1).
///
/// Numbers are rounded to 32 bits. Sequence number, sensor, model, principle, rate, areas, thresholds, overload, variances,
/// calibration and other channels than the force are lost.
///
/// # Errors
/// If the array is invalid or has no forces in newtons.
pub fn to_cloud(array: &TactileArray) -> Result<PointCloud2, ArrayError> {
    let forces = array.forces()?;
    let status = array.channel(names::FORCE).map_or(&[][..], |c| &c.status);
    let bits = |list: &[u8], element: usize, bit| {
        u8::from(list.get(element).is_some_and(|bits| bits & bit != 0))
    };
    let mut data = Vec::with_capacity(POINT * forces.len());
    let poses = array.positions.iter().zip(&array.orientations);
    for (element, ((&position, &q), force)) in poses.zip(forces).enumerate() {
        let place = DVec3::from(position).to_array();
        let numbers = place.into_iter().chain(force.to_array());
        for number in numbers.chain([q.x, q.y, q.z, q.w]) {
            data.extend((number as f32).to_le_bytes());
        }
        data.extend([
            bits(&array.contact, element, SLIP),
            u8::from(force.is_finite()),
            bits(&array.contact, element, CONTACT),
            bits(status, element, SATURATED),
        ]);
    }
    Ok(PointCloud2 {
        header: array.header.clone(),
        height: 1,
        width: array.elements() as u32,
        fields: fields(&NUMBERS, &FLAGS),
        is_bigendian: false,
        point_step: POINT as u32,
        row_step: data.len() as u32,
        data,
        // Unknown forces are NaN.
        is_dense: false,
    })
}

/// Converts a cloud of forces to an array. The fields `x y z fx fy fz` are required, in 32 or 64 bits; without `qx qy qz
/// qw`, normals point away from the origin, as on a dome. Contact is unknown without the fields `contact` and `slip`.
/// All other properties are unknown.
///
/// # Errors
/// If a required field is missing, or the cloud has fewer bytes than points.
pub fn from_cloud(cloud: &PointCloud2) -> Result<TactileArray, ArrayError> {
    if cloud.is_bigendian {
        return Err(ArrayError::BigEndian);
    }
    let field = |name| cloud.float_field(name).ok_or(ArrayError::Field(name));
    let at = [field("x")?, field("y")?, field("z")?];
    let force = [field("fx")?, field("fy")?, field("fz")?];
    let turn: Option<Vec<_>> = NUMBERS[6..].iter().map(|n| cloud.float_field(n)).collect();
    let flags = FLAGS.map(|name| cloud.byte_field(name));
    let points = cloud
        .points()
        .map_err(|(expected, actual)| ArrayError::Count {
            list: "the bytes of the cloud".into(),
            expected,
            actual,
        })?;
    let mut array = TactileArray::unknown(&cloud.header);
    let mut channel = TactileChannel::of_forces();
    for point in points {
        let vector = |of: &[FloatField; 3]| DVec3::from_array(of.map(|field| field.read(point)));
        let (position, force) = (vector(&at), vector(&force));
        let rotation = match turn.as_deref() {
            Some(&[x, y, z, w]) => DQuat::from_array([x, y, z, w].map(|field| field.read(point))),
            _ => {
                let outward = SensingElement::facing(position.normalize_or(DVec3::X));
                DQuat::from_mat3(&outward.rotation)
            }
        };
        let is_set = |flag: Option<usize>| flag.map(|at| point.get(at).is_some_and(|b| *b != 0));
        let [slip, valid, contact, saturated] = flags.map(is_set);
        array.positions.push(position.into());
        array.orientations.push(rotation.into());
        channel.values.extend(force.to_array());
        let is_valid = valid.unwrap_or(true) && force.is_finite();
        let status = [(!is_valid, INVALID), (saturated == Some(true), SATURATED)];
        channel.status.push(joined(&status));
        if slip.is_some() || contact.is_some() {
            let contact = [(contact == Some(true), CONTACT), (slip == Some(true), SLIP)];
            array.contact.push(joined(&contact));
        }
    }
    array.channels.push(channel);
    array.check()?;
    Ok(array)
}
