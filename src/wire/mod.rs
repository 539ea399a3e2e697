//! The wire format of recordings and of the link: ROS 2 messages in CDR.

pub mod cdr;
mod message;

pub use cdr::WireError;
pub use message::{Message, Quaternion, Vector3};
pub(crate) use message::{message, vector3_schema};
