//! `sensor_msgs/PointCloud2`.

use super::header::{Header, header_schema, nested};
use crate::wire::Message;
use serde::{Deserialize, Serialize};

/// What stands where in a point's bytes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct PointField {
    /// What it is called.
    pub name: String,
    /// Where it begins, bytes.
    pub offset: u32,
    /// What it is: [`Self::UINT8`], [`Self::FLOAT32`].
    pub datatype: u8,
    /// How many of them there are.
    pub count: u32,
}

impl PointField {
    /// A byte.
    pub const UINT8: u8 = 2;
    /// A number of 32 bits.
    pub const FLOAT32: u8 = 7;
}

/// Points, each of which has fields.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PointCloud2 {
    /// When, and in which frame.
    pub header: Header,
    /// Rows: 1.
    pub height: u32,
    /// Points.
    pub width: u32,
    /// What a point's bytes are.
    pub fields: Vec<PointField>,
    /// Whether the most significant byte of a number comes first.
    pub is_bigendian: bool,
    /// Bytes of a point.
    pub point_step: u32,
    /// Bytes of a row.
    pub row_step: u32,
    /// The points' bytes.
    #[serde(with = "serde_bytes")]
    pub data: Vec<u8>,
    /// Whether all points have all fields.
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
