//! Messages with readings, as published by the rig program.

use crate::messages::freshness::Echo;
use crate::messages::message::{DirectForces, MessageHeader, PictureMessage, StateMessage};
use crate::transport::endpoints::LinkError;
use crate::transport::outlet::encode;
use crate::transport::topic::Topic;

/// Message with readings, which may be published again.
pub(super) enum Reading {
    State(StateMessage),
    Picture(usize, PictureMessage),
    Forces(usize, DirectForces),
}

impl Reading {
    pub fn header_mut(&mut self) -> &mut MessageHeader {
        match self {
            Self::State(message) => &mut message.header,
            Self::Picture(_, message) => &mut message.header,
            Self::Forces(_, message) => &mut message.header,
        }
    }

    /// Returns the topic and the encoded message.
    pub fn encoded(&self) -> Result<(Topic, Vec<u8>), LinkError> {
        Ok(match self {
            Self::State(message) => (Topic::State, encode(message)?),
            Self::Picture(finger, message) => (Topic::Picture(*finger), encode(message)?),
            Self::Forces(finger, message) => (Topic::DirectForces(*finger), encode(message)?),
        })
    }
}

/// Latest published image or forces of a finger.
#[derive(Debug, Clone, Copy)]
pub(super) struct Exposed {
    pub number: u64,
    /// The hand's latest step when the image was taken, and that time (s).
    pub taken: (Echo, f64),
}
