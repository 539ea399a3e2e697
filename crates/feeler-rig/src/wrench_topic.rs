//! Force sensor that reads wrenches from a ROS 2 topic.

use std::str::FromStr;

#[cfg(feature = "ros2")]
pub use topic::{WrenchError, WrenchTopic};

/// Expected form of an address.
const EXPECTED: &str = "expected ros2:/TOPIC, or ros2:/TOPIC?connect=tcp/HOST:PORT&domain=NUMBER";

/// Address of a wrench topic: `/wrench?connect=tcp/10.0.0.5:7447&domain=3`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WrenchAddress {
    topic: String,
    /// Endpoint of the ROS 2 router or of another node.
    connect: Option<String>,
    domain: Option<u32>,
}

impl FromStr for WrenchAddress {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (topic, query) = text.split_once('?').unwrap_or((text, ""));
        let mut address = Self {
            topic: topic.into(),
            connect: None,
            domain: None,
        };
        if !topic.starts_with('/') || topic.len() < 2 {
            return Err(format!("{topic:?} is not a topic; {EXPECTED}"));
        }
        for pair in query.split('&').filter(|pair| !pair.is_empty()) {
            let wrong = || format!("unknown parameter {pair:?}; {EXPECTED}");
            match pair.split_once('=').ok_or_else(wrong)? {
                ("connect", place) if !place.is_empty() => address.connect = Some(place.into()),
                ("domain", number) => {
                    address.domain = Some(number.parse().map_err(|_| wrong())?);
                }
                _ => return Err(wrong()),
            }
        }
        Ok(address)
    }
}

#[cfg(not(feature = "ros2"))]
impl WrenchAddress {
    /// Returns an error: this build has no ROS 2.
    pub fn not_built(&self) -> feeler_console::CommandError {
        let Self {
            topic,
            connect: _,
            domain: _,
        } = self;
        format!("ros2:{topic}: this program was built without ROS 2; build it with --features ros2")
            .into()
    }
}

#[cfg(feature = "ros2")]
mod topic {
    use super::WrenchAddress;
    use crate::ros2::domain_of_environment;
    use feeler_console::CommandError;
    use feeler_record::ros::WrenchStamped;
    use feeler_record::wire::cdr;
    use feeler_ros2::{
        NODE_ENDPOINT, Node, NodeConfig, NodeName, Qos, ROUTER_ENDPOINT, Subscription,
    };
    use feeler_sources::ForceSample;
    use std::cell::Cell;
    use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};
    use std::time::{Duration, Instant};

    /// Name of the node.
    const NODE_NAME: &str = "feeler_calibrate";
    /// Time without a wrench after which the topic is silent.
    const SILENCE: Duration = Duration::from_millis(500);
    /// Maximum number of waiting samples: one second of the fastest sensor.
    const WAITING: usize = 8192;

    /// Error of a wrench topic.
    #[derive(Debug, Clone, PartialEq, thiserror::Error)]
    pub enum WrenchError {
        /// No wrench arrived for some time.
        #[error(
            "{topic}: no wrench for {} ms; expected a publisher of geometry_msgs/WrenchStamped in domain {domain}",
            SILENCE.as_millis()
        )]
        Silent {
            /// The topic.
            topic: String,
            /// The ROS domain.
            domain: u32,
        },
        /// A wrench is not finite.
        #[error("{topic}: expected finite forces and torques, got {actual:?}")]
        Value {
            /// The topic.
            topic: String,
            /// Force (N) and torque (N m).
            actual: [f64; 6],
        },
    }

    /// A subscribed topic.
    pub struct WrenchTopic {
        topic: String,
        samples: Receiver<ForceSample>,
        /// Time of the latest wrench, or of the latest error that reports a silent topic.
        heard: Cell<Instant>,
        node: Node,
        _subscription: Subscription,
    }

    impl WrenchTopic {
        /// Subscribes to the topic at `address`.
        pub fn open(address: &WrenchAddress) -> Result<Self, CommandError> {
            let domain = address.domain.map_or_else(domain_of_environment, Ok)?;
            let router = || ROUTER_ENDPOINT.to_string();
            let mut node = Node::open(NodeConfig {
                name: NodeName::new(domain, "/", NODE_NAME)?,
                connect: vec![address.connect.clone().unwrap_or_else(router)],
                listen: vec![NODE_ENDPOINT.into()],
            })?;
            let (sender, samples) = sync_channel(WAITING);
            let heard = move |bytes: &[u8], _| {
                let Ok(message) = cdr::decode::<WrenchStamped>(bytes) else {
                    return;
                };
                let (force, torque) = (message.wrench.force, message.wrench.torque);
                // If samples are not taken for a second, newer ones are dropped.
                let _ = sender.try_send(ForceSample {
                    at: Instant::now(),
                    wrench: [force.x, force.y, force.z, torque.x, torque.y, torque.z],
                    lost: 0,
                });
            };
            let topic = &address.topic;
            Ok(Self {
                topic: topic.clone(),
                samples,
                heard: Cell::new(Instant::now()),
                _subscription: node.subscribe::<WrenchStamped>(topic, Qos::SENSOR_DATA, heard)?,
                node,
            })
        }

        /// Returns the next sample, or `None` if none has arrived: the force on the sensor's tool side by the object
        /// that touches it (N) and the torque (N m), in the sensor's frame. Does not block.
        ///
        /// # Errors
        /// If the topic is silent or a wrench is not finite. Later calls may succeed.
        pub fn next_sample(&self) -> Result<Option<ForceSample>, WrenchError> {
            let topic = || self.topic.clone();
            match self.samples.try_recv() {
                Ok(sample) => {
                    self.heard.set(sample.at);
                    let actual = sample.wrench;
                    match actual.iter().all(|value| value.is_finite()) {
                        true => Ok(Some(sample)),
                        false => Err(WrenchError::Value {
                            topic: topic(),
                            actual,
                        }),
                    }
                }
                Err(TryRecvError::Empty) if self.heard.get().elapsed() > SILENCE => {
                    self.heard.set(Instant::now());
                    let domain = self.node.name().domain();
                    Err(WrenchError::Silent {
                        topic: topic(),
                        domain,
                    })
                }
                Err(_) => Ok(None),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parses_addresses_and_explains_errors() {
        let read = |text: &str| text.parse::<WrenchAddress>();
        let whole = read("/ft/wrench?connect=tcp/10.0.0.5:7447&domain=3").expect("an address");
        assert_eq!(whole.topic, "/ft/wrench");
        assert_eq!(whole.connect.as_deref(), Some("tcp/10.0.0.5:7447"));
        assert_eq!(whole.domain, Some(3));
        assert_eq!(read("/wrench").expect("an address").domain, None);
        for text in ["", "/", "wrench", "/a?domain=x", "/a?connect=", "/a?b"] {
            let error = read(text).expect_err(text);
            assert!(error.contains("ros2:/TOPIC"), "{error}");
        }
    }
}
