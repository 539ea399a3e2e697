//! Messages received by the sensor program of one finger: the hand's steps, and images of a remote rig.

use super::inbox::Inbox;
use super::peers::{Expected, Peers};
use crate::messages::decode::read;
use crate::messages::freshness::Echo;
use crate::messages::message::{
    DirectForces, HandMode, MessageHeader, NO_FINGER, PictureMessage, ProgramKind,
};
use crate::messages::plausible::{check_forces, check_protocol};
use crate::messages::rejection::{Rejection, Rejections};
use crate::messages::sequence::Sequence;
use crate::transport::topic::Topic;
use std::collections::VecDeque;

/// Maximum number of queued images. Older ones would be stale before they are processed.
const MAX_WAITING: usize = 8;

/// Number of the hand's steps that are kept, to find the latest one received before an image.
const REMEMBERED: usize = 16;

/// Image or forces of one exposure, received from the rig.
#[derive(Debug, Clone, PartialEq)]
pub enum Exposed {
    /// Camera image.
    Picture(PictureMessage),
    /// Forces, from a rig that renders no images.
    Forces(DirectForces),
}

impl Exposed {
    /// Returns the header and the frame sequence number.
    pub fn header(&self) -> (MessageHeader, u64) {
        match self {
            Self::Picture(picture) => (picture.header, picture.frame),
            Self::Forces(forces) => (forces.header, forces.frame),
        }
    }
}

/// Inbox of one finger's sensor program.
#[derive(Debug, Clone)]
pub struct SenseInbox {
    finger: u32,
    elements: usize,
    size: (usize, usize),
    steps: Sequence,
    echoes: VecDeque<Echo>,
    exposed: Sequence,
    waiting: VecDeque<Exposed>,
    /// Number of images lost in transit or dropped from the full queue.
    pub lost: u64,
    peers: Peers,
    /// Counters of rejected messages.
    pub rejected: Rejections,
}

impl Inbox for SenseInbox {
    fn take_in(&mut self, topic: Topic, bytes: &[u8], now: f64) -> Result<(), Rejection> {
        match topic {
            Topic::Heartbeat(place) => self.peers.heard(place, bytes, now).map(|_| ()),
            Topic::Mode => read(bytes).and_then(|mode| self.take_step(&mode, now)),
            Topic::Picture(_) => read(bytes).and_then(|picture| self.take_picture(picture, now)),
            Topic::DirectForces(_) => read(bytes).and_then(|forces| self.take_forces(forces, now)),
            _ => Err(Rejection::Stranger),
        }
    }

    fn peers(&self) -> &Peers {
        &self.peers
    }

    fn rejected(&mut self) -> &mut Rejections {
        &mut self.rejected
    }
}

impl SenseInbox {
    /// Creates an empty inbox for `finger` with its number of elements and images of `size` (width, height in px).
    /// Other programs must match `expected`.
    pub fn new(finger: usize, elements: usize, size: (usize, usize), expected: Expected) -> Self {
        Self {
            finger: finger as u32,
            elements,
            size,
            steps: Sequence::default(),
            echoes: VecDeque::with_capacity(REMEMBERED),
            exposed: Sequence::default(),
            waiting: VecDeque::with_capacity(MAX_WAITING),
            lost: 0,
            peers: Peers::new(expected),
            rejected: Rejections::default(),
        }
    }

    fn take_step(&mut self, mode: &HandMode, now: f64) -> Result<(), Rejection> {
        let header = mode.header;
        self.peers.check_hand(header)?;
        let before = self.steps.newest();
        self.steps.accept(header.number(), now)?;
        if before.is_some_and(|(hand, _)| hand != header.instance) {
            self.echoes.clear();
        }
        if self.echoes.len() == REMEMBERED {
            self.echoes.pop_front();
        }
        self.echoes.push_back(Echo {
            step: header.sequence,
            token: mode.token,
            arrived: now,
        });
        Ok(())
    }

    fn take_picture(&mut self, picture: PictureMessage, now: f64) -> Result<(), Rejection> {
        check_protocol(picture.header.protocol)?;
        let (width, height) = self.size;
        let size = (picture.width as usize, picture.height as usize);
        if size != self.size || picture.pixels.len() != width * height {
            return Err(Rejection::Size);
        }
        self.queue(picture.header, picture.finger, now)?;
        self.waiting.push_back(Exposed::Picture(picture));
        Ok(())
    }

    fn take_forces(&mut self, forces: DirectForces, now: f64) -> Result<(), Rejection> {
        check_protocol(forces.header.protocol)?;
        check_forces(self.elements, &forces.forces)?;
        self.queue(forces.header, forces.finger, now)?;
        self.waiting.push_back(Exposed::Forces(forces));
        Ok(())
    }

    /// Checks the header of a message and removes the oldest message if the queue is full.
    fn queue(&mut self, header: MessageHeader, finger: u32, now: f64) -> Result<(), Rejection> {
        if finger != self.finger {
            return Err(Rejection::Size);
        }
        if !header.stamp.is_finite() {
            return Err(Rejection::NotFinite);
        }
        self.peers
            .check(header.instance, &ProgramKind::World, NO_FINGER)?;
        let number = header.number();
        // A repetition is accepted: in lockstep, the rig resends because the answer may have been lost.
        if self.exposed.newest() != Some(number) {
            let lost = self.exposed.accept(number, now)?;
            self.lost = self.lost.saturating_add(lost);
        }
        if self.waiting.len() == MAX_WAITING {
            self.waiting.pop_front();
            self.lost = self.lost.saturating_add(1);
        }
        Ok(())
    }

    /// Removes and returns the oldest queued exposure.
    pub fn take_next(&mut self) -> Option<Exposed> {
        self.waiting.pop_front()
    }

    /// Returns the latest step of the hand received by `at` (s, on the program's clock). Messages about an image taken
    /// at that time contain this step as their echo.
    pub fn echo_at(&self, at: f64) -> Echo {
        let before = self.echoes.iter().rev().find(|echo| echo.arrived <= at);
        before.copied().unwrap_or_default()
    }
}
