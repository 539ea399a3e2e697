#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

#[macro_use]
mod texts;

pub(crate) mod attachment;
#[cfg(feature = "zenoh")]
pub(crate) mod client;
pub(crate) mod cloud;
#[cfg(feature = "zenoh")]
pub(crate) mod freshness;
#[cfg(feature = "zenoh")]
pub(crate) mod gripper;
pub(crate) mod hand_messages;
#[cfg(feature = "zenoh")]
pub(crate) mod hand_node;
pub(crate) mod joint_reader;
pub(crate) mod key;
pub mod message;
pub(crate) mod message_text;
pub(crate) mod name;
#[cfg(feature = "zenoh")]
pub(crate) mod node;
#[cfg(feature = "zenoh")]
pub(crate) mod node_error;
pub mod parameter;
#[cfg(feature = "zenoh")]
pub(crate) mod parameter_server;
#[cfg(feature = "zenoh")]
pub(crate) mod publisher;
pub(crate) mod qos;
#[cfg(feature = "zenoh")]
pub(crate) mod ros_hand;
#[cfg(feature = "zenoh")]
pub(crate) mod ros_sensor;
#[cfg(feature = "zenoh")]
pub(crate) mod server;
pub(crate) mod token;
pub(crate) mod type_description;
#[cfg(feature = "zenoh")]
pub(crate) mod velocity_sender;
#[cfg(feature = "zenoh")]
pub(crate) mod wall_clock;

pub use attachment::{Attachment, AttachmentError};
#[cfg(feature = "zenoh")]
pub use client::Client;
pub use cloud::{CloudError, read_forces};
#[cfg(feature = "zenoh")]
pub use freshness::{GraphClock, StaleError};
#[cfg(feature = "zenoh")]
pub use gripper::GripperConfig;
pub use hand_messages::{HandMessages, Touch};
#[cfg(feature = "zenoh")]
pub use hand_node::HandPublishers;
pub use joint_reader::{JointError, JointReader};
pub use key::{dds_type, key};
pub use message_text::DescriptionError;
pub use name::{NameError, NodeName};
#[cfg(feature = "zenoh")]
pub use node::{NODE_ENDPOINT, Node, NodeConfig, ROUTER_ENDPOINT, Subscription};
#[cfg(feature = "zenoh")]
pub use node_error::NodeError;
#[cfg(feature = "zenoh")]
pub use parameter_server::serve_parameters;
#[cfg(feature = "zenoh")]
pub use publisher::Publisher;
pub use qos::{Durability, History, Qos, Reliability};
#[cfg(feature = "zenoh")]
pub use ros_hand::{RosCommands, RosHand, RosHandConfig, RosHandError};
#[cfg(feature = "zenoh")]
pub use ros_sensor::{RosSensor, SensorAge};
pub use token::{Endpoint, EndpointKind, Token};
pub use type_description::{Service, TypeDescription};
