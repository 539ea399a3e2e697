//! `sensor_msgs/CompressedImage`.

use super::header::{Header, header_schema};
use crate::wire::Message;
use serde::{Deserialize, Serialize};

/// An image in the format of an image file.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct CompressedImage {
    /// Time and camera.
    pub header: Header,
    /// The format: `png`.
    pub format: String,
    /// Contents of the image file. Serialized as one block: byte by byte, it would take a hundred times as long.
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
