//! `sensor_msgs/CompressedImage`.

use super::header::{Header, header_schema};
use crate::wire::Message;
use serde::{Deserialize, Serialize};

/// A picture in the format of a picture file.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct CompressedImage {
    /// When it was taken, and by which camera.
    pub header: Header,
    /// The format: `png`.
    pub format: String,
    /// The file. In one piece: byte by byte, it would take a hundred times as long.
    #[serde(with = "serde_bytes")]
    pub data: Vec<u8>,
}

impl Message for CompressedImage {
    const SCHEMA_NAME: &'static str = "sensor_msgs/msg/CompressedImage";
    const SCHEMA: &'static str = concat!(
        "std_msgs/Header header\n",
        "string format\n",
        "uint8[] data\n",
        header_schema!(),
    );
}
