//! `sensor_msgs/PointCloud2`.

use super::header::{Header, header_schema, nested};
use crate::wire::Message;
use serde::{Deserialize, Serialize};

/// Layout of one field in a point's bytes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PointField {
    /// Name of the field.
    pub name: String,
    /// Offset in bytes.
    pub offset: u32,
    /// Data type, such as [`Self::UINT8`].
    pub datatype: u8,
    /// Number of elements.
    pub count: u32,
}

impl PointField {
    /// 8-bit unsigned integer.
    pub const UINT8: u8 = 2;
    /// 32-bit floating-point number.
    pub const FLOAT32: u8 = 7;
    /// 64-bit floating-point number.
    pub const FLOAT64: u8 = 8;
}

/// Fields of a point whose bytes are 32-bit `numbers`, followed by 8-bit `flags`.
pub(crate) fn fields(numbers: &[&str], flags: &[&str]) -> Vec<PointField> {
    let field = |(name, offset): (&&str, u32), datatype| PointField {
        name: name.to_string(),
        offset,
        datatype,
        count: 1,
    };
    let end = 4 * numbers.len() as u32;
    let numbers = numbers.iter().zip((0..).step_by(4));
    let numbers = numbers.map(|at| field(at, PointField::FLOAT32));
    let flags = flags.iter().zip(end..);
    let flags = flags.map(|at| field(at, PointField::UINT8));
    numbers.chain(flags).collect()
}

/// Place of a floating-point number in the bytes of a point.
#[derive(Debug, Clone, Copy)]
pub struct FloatField {
    offset: usize,
    is_double: bool,
}

impl FloatField {
    /// Reads the little-endian number from a point's bytes; NaN if they are too few.
    pub fn read(self, point: &[u8]) -> f64 {
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

/// A cloud of points with fields.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PointCloud2 {
    /// Time and coordinate frame.
    pub header: Header,
    /// Number of rows: 1.
    pub height: u32,
    /// Number of points per row.
    pub width: u32,
    /// Fields of a point.
    pub fields: Vec<PointField>,
    /// `true` if numbers are big-endian.
    pub is_bigendian: bool,
    /// Size of a point in bytes.
    pub point_step: u32,
    /// Size of a row in bytes.
    pub row_step: u32,
    /// Bytes of the points.
    #[serde(with = "serde_bytes")]
    pub data: Vec<u8>,
    /// `true` if all fields of all points are valid.
    pub is_dense: bool,
}

impl PointCloud2 {
    /// Locates the floating-point field `name`. `None` if it is missing, has another type, or extends beyond a point.
    pub fn float_field(&self, name: &str) -> Option<FloatField> {
        let field = self.field(name)?;
        let bytes: u32 = match field.datatype {
            PointField::FLOAT32 => 4,
            PointField::FLOAT64 => 8,
            _ => return None,
        };
        let end = field.offset.checked_add(bytes)?;
        (end <= self.point_step).then_some(FloatField {
            offset: field.offset as usize,
            is_double: bytes == 8,
        })
    }

    /// Offset of the 8-bit field `name` in a point, or `None` if it is missing or has another type.
    pub fn byte_field(&self, name: &str) -> Option<usize> {
        let field = self.field(name)?;
        (field.datatype == PointField::UINT8).then_some(field.offset as usize)
    }

    fn field(&self, name: &str) -> Option<&PointField> {
        self.fields.iter().find(|field| field.name == name)
    }

    /// Bytes of each point, row by row.
    ///
    /// # Errors
    /// If the cloud has fewer bytes than its points. Returns the expected and the actual number of bytes.
    pub fn points(&self) -> Result<impl Iterator<Item = &[u8]> + '_, (usize, usize)> {
        let [height, width] = [self.height, self.width].map(|number| number as usize);
        let (step, row_step) = (self.point_step as usize, self.row_step as usize);
        let row = width.saturating_mul(step);
        // A single row may leave its size unset.
        let stride = if height == 1 { row } else { row_step.max(row) };
        let rows_before = height.saturating_sub(1).saturating_mul(stride);
        let expected = match width.min(height) {
            0 => 0,
            _ => rows_before.saturating_add(row),
        };
        if (expected > 0 && step == 0) || self.data.len() < expected {
            return Err((expected.max(1), self.data.len()));
        }
        let is_empty = expected == 0;
        let rows = (0..if is_empty { 0 } else { height }).map(move |index| index * stride);
        Ok(rows.flat_map(move |start| {
            let row = self.data.get(start..start + row).unwrap_or_default();
            row.chunks_exact(step.max(1))
        }))
    }
}

impl Message for PointCloud2 {
    const SCHEMA_NAME: &'static str = "sensor_msgs/msg/PointCloud2";
    const SCHEMA: &'static str = concat!(
        "std_msgs/Header header\n",
        "uint32 height\n",
        "uint32 width\n",
        "PointField[] fields\n",
        "bool is_bigendian\n",
        "uint32 point_step\n",
        "uint32 row_step\n",
        "uint8[] data\n",
        "bool is_dense\n",
        header_schema!(),
        nested!(
            "sensor_msgs/PointField",
            "uint8 INT8=1",
            "uint8 UINT8=2",
            "uint8 INT16=3",
            "uint8 UINT16=4",
            "uint8 INT32=5",
            "uint8 UINT32=6",
            "uint8 FLOAT32=7",
            "uint8 FLOAT64=8",
            "string name",
            "uint32 offset",
            "uint8 datatype",
            "uint32 count",
        ),
    );
}
