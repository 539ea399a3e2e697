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
    /// Data type: [`Self::UINT8`] or [`Self::FLOAT32`].
    pub datatype: u8,
    /// Number of elements.
    pub count: u32,
}

impl PointField {
    /// 8-bit unsigned integer.
    pub const UINT8: u8 = 2;
    /// 32-bit floating-point number.
    pub const FLOAT32: u8 = 7;
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
