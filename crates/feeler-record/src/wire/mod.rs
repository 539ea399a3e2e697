//! The wire format of recordings and of the link: ROS 2 messages in CDR.

pub mod cdr;
mod message;

pub use crate::{message, quaternion_schema, vector3_schema};
pub use cdr::WireError;
pub use message::{Message, Quaternion, Vector3};
