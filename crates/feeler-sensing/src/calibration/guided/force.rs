//! Force sensors under a fingertip.

use feeler_console::CommandError;
use feeler_rig::WrenchAddress;
#[cfg(feature = "ros2")]
use feeler_rig::WrenchTopic;
use feeler_sources::{ForceSample, NetFt, NetFtAddress};
use std::str::FromStr;

/// Prefix of a ROS 2 topic's address.
const ROS2: &str = "ros2:";

/// Address of a force sensor.
#[derive(Debug, Clone)]
pub enum ForceAddress {
    /// ATI Net F/T sensor.
    NetFt(NetFtAddress),
    /// Topic of a ROS 2 graph.
    Ros2(WrenchAddress),
}

impl FromStr for ForceAddress {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.strip_prefix(ROS2) {
            Some(rest) => Ok(Self::Ros2(rest.parse()?)),
            None => text
                .parse()
                .map(Self::NetFt)
                .map_err(|error| format!("{error}; or ros2:/TOPIC of geometry_msgs/WrenchStamped")),
        }
    }
}

/// A connected force sensor.
pub enum ForceSensor {
    NetFt(NetFt),
    #[cfg(feature = "ros2")]
    Ros2(Box<WrenchTopic>),
}

impl ForceSensor {
    /// Connects to the sensor at `address`.
    pub fn connect(address: &ForceAddress) -> Result<Self, CommandError> {
        match address {
            ForceAddress::NetFt(address) => Ok(Self::NetFt(NetFt::connect(address)?)),
            #[cfg(feature = "ros2")]
            ForceAddress::Ros2(address) => Ok(Self::Ros2(Box::new(WrenchTopic::open(address)?))),
            #[cfg(not(feature = "ros2"))]
            ForceAddress::Ros2(address) => Err(address.not_built()),
        }
    }

    /// Returns the next sample, or `None` if none has arrived. Does not block.
    pub fn next_sample(&self) -> Result<Option<ForceSample>, CommandError> {
        match self {
            Self::NetFt(sensor) => Ok(sensor.next_sample()?),
            #[cfg(feature = "ros2")]
            Self::Ros2(topic) => Ok(topic.next_sample()?),
        }
    }
}
