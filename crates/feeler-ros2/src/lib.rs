#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

#[macro_use]
mod texts;

pub mod attachment;
pub mod cloud;
#[cfg(feature = "zenoh")]
pub mod freshness;
pub mod hand_messages;
#[cfg(feature = "zenoh")]
pub mod hand_node;
pub mod joint_reader;
pub mod key;
pub mod message;
mod message_text;
pub mod name;
#[cfg(feature = "zenoh")]
pub mod node;
pub mod parameter;
#[cfg(feature = "zenoh")]
pub mod parameter_server;
#[cfg(feature = "zenoh")]
pub mod publisher;
pub mod qos;
#[cfg(feature = "zenoh")]
pub mod ros_hand;
#[cfg(feature = "zenoh")]
pub mod ros_sensor;
#[cfg(feature = "zenoh")]
pub mod server;
pub mod token;
pub mod type_description;
#[cfg(feature = "zenoh")]
mod velocity_sender;
