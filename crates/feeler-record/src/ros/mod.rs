//! Standard ROS 2 messages, for viewers and tools that do not support feeler's messages.
//!
//! Names, order and texts of the fields are those of `common_interfaces`; they determine the wire format.

pub mod compressed_image;
mod header;
mod joint_state;
mod marker;
mod point_cloud;
mod text;
mod transform;
mod wrench;

pub use compressed_image::CompressedImage;
pub use header::{Header, Time};
pub(crate) use header::{header_schema, nested, quaternion_schema, xyz_schema};
pub use joint_state::JointState;
pub use marker::{ColorRGBA, Marker, MarkerArray, MarkerType};
pub(crate) use point_cloud::fields;
pub use point_cloud::{FloatField, PointCloud2, PointField};
pub use text::Text;
pub use transform::{TFMessage, Transform, TransformStamped};
pub use wrench::{Wrench, WrenchStamped};

/// Implements recording for messages derived from others: they are for viewers, not part of the digest and not read
/// back.
macro_rules! derived {
    ($($type:ty, $stamp:expr);+ $(;)?) => {
        $(impl $crate::messages::channels::Stamped for $type {
            fn stamp(&self) -> f64 {
                let stamp: fn(&$type) -> f64 = $stamp;
                stamp(self)
            }
        }

        impl $crate::messages::recorded::RecordedMessage for $type {
            const DERIVED: bool = true;

            fn read_into(
                _: &mut $crate::reading::recording::Recording,
                _: Option<usize>,
                _: &[u8],
                _: $crate::reading::recording::PictureAt,
            ) -> Result<(), String> {
                Ok(())
            }
        })+
    };
}

derived!(
    JointState, |message| message.header.seconds();
    WrenchStamped, |message| message.header.seconds();
    PointCloud2, |message| message.header.seconds();
    TFMessage, |message| message.transforms.first().map_or(0.0, |t| t.header.seconds());
    MarkerArray, |message| message.markers.first().map_or(0.0, |m| m.header.seconds());
    Text, |message| message.stamp;
);
