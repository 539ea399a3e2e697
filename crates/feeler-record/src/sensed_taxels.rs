//! What a taxel array of another maker felt, without any run around it: one MCAP file of ROS 2 messages.

use super::channels::Tactile;
use super::container::{Container, find, log_time};
use super::error::RecordError;
use super::memory::MessageSink;
use super::sensed::TACTILE;
use super::topic::{Channel, RecordedMessage, RecordedTopic, topics};
use crate::ros::{MarkerArray, PointCloud2, Time, WrenchStamped};
use crate::scene::element_dots;
use crate::taxels::{Elements, taxels};
use crate::wire::cdr;
use ::mcap::WriteOptions;
use feeler::sensor::layout::SensingElement;
use feeler::sensor::reading::TactileFrame;
use glam::DVec3;
use std::collections::BTreeMap;
use std::path::Path;

/// Name of the metadata record at the file's beginning: which array it is, in which unit its forces are, its layout.
pub const TAXELS: &str = "feeler.taxels";

/// Time between two pictures of the scene, s.
const FRAME_TIME: f64 = 1.0 / 30.0;

/// What does not change of a taxel array.
#[derive(Debug, Clone)]
pub struct TaxelFacts {
    /// What the array is called.
    pub name: String,
    /// Unit of the forces: `N` or `counts`.
    pub unit: &'static str,
    /// Its layout file.
    pub layout: String,
    /// Its elements, each with its place, m in the fingertip frame `T`.
    pub elements: Vec<(SensingElement, DVec3)>,
}

/// Writes [`Tactile`] frames to [`TACTILE`], and what viewers draw: taxels and forces as points of a cloud and as dots of
/// a scene and, of forces in newtons, their sum as a wrench; all in the frame of finger 0's dome, which is `T`.
///
/// Until it is [finished](Self::finish) the file lacks its end, and MCAP readers say so.
pub struct TaxelWriter {
    messages: Messages,
    elements: Elements,
    cloud: PointCloud2,
    scene: MarkerArray,
    /// Of forces in newtons.
    wrench: Option<WrenchStamped>,
    /// Stamp of the newest cloud, s.
    drawn: Option<f64>,
}

impl TaxelWriter {
    /// Creates the file.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn create(path: &Path, facts: TaxelFacts) -> Result<Self, RecordError> {
        let mut container = Container::create(path, WriteOptions::new())?;
        let is_newton = facts.unit == "N";
        let metadata = [
            ("name", facts.name),
            ("unit", facts.unit.to_string()),
            ("layout", facts.layout),
        ];
        let metadata = metadata.map(|(key, value)| (key.to_string(), value));
        container.metadata(TAXELS, BTreeMap::from(metadata))?;
        let elements = Elements::new(facts.elements);
        let cloud = taxels(0, &elements);
        let wrench = is_newton.then(|| WrenchStamped {
            header: cloud.header.clone(),
            ..WrenchStamped::default()
        });
        let mut channels: Vec<Channel> = vec![
            TACTILE.into(),
            topics::taxels(0).into(),
            topics::SCENE.into(),
        ];
        channels.extend(is_newton.then(|| Channel::from(topics::wrench(0))));
        container.register(&channels)?;
        Ok(Self {
            messages: Messages {
                container,
                channels,
                buffer: Vec::new(),
            },
            scene: MarkerArray {
                markers: vec![element_dots(elements.tips())],
            },
            elements,
            cloud,
            wrench,
            drawn: None,
        })
    }

    /// Writes a frame.
    ///
    /// # Errors
    /// When the file cannot be written, or the frame's stamp is no time of a recording (before 0).
    pub fn write(&mut self, frame: &TactileFrame) -> Result<(), RecordError> {
        let forces = frame.forces.iter().map(|&force| force.into());
        let tactile = Tactile {
            sequence: frame.sequence,
            stamp: frame.stamp,
            forces: forces.collect(),
        };
        self.messages.write(TACTILE, &tactile)?;
        let Some(stamp) = Time::of(frame.stamp) else {
            return Ok(());
        };
        self.elements.take_forces(&frame.forces);
        if let Some(wrench) = &mut self.wrench {
            wrench.header.stamp = stamp;
            wrench.wrench = self.elements.wrench();
            self.messages.write(topics::wrench(0), wrench)?;
        }
        if self.drawn.is_none() {
            for marker in &mut self.scene.markers {
                marker.header.stamp = stamp;
            }
            self.messages.write(topics::SCENE, &self.scene)?;
        }
        // A time that goes back is drawn, too.
        let due = (self.drawn).is_none_or(|drawn| (frame.stamp - drawn).abs() >= FRAME_TIME);
        if due {
            self.drawn = Some(frame.stamp);
            self.cloud.header.stamp = stamp;
            self.elements.fill(&mut self.cloud, |_| false);
            self.messages.write(topics::taxels(0), &self.cloud)?;
        }
        Ok(())
    }

    /// Hands what was written to the system.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn flush(&mut self) -> Result<(), RecordError> {
        self.messages.container.flush()
    }

    /// Writes the end of the file and closes it.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn finish(self) -> Result<(), RecordError> {
        self.messages.container.close()
    }
}

/// The file's messages.
struct Messages {
    container: Container,
    channels: Vec<Channel>,
    buffer: Vec<u8>,
}

impl MessageSink for Messages {
    fn write<M: RecordedMessage>(
        &mut self,
        topic: RecordedTopic<M>,
        message: &M,
    ) -> Result<(), RecordError> {
        // All topics are of the rig or of its one finger.
        let channel = find(&self.channels, 1, topic)?;
        let log_time = log_time(topic, message)?;
        self.buffer.clear();
        cdr::encode(message, &mut self.buffer)?;
        self.container.write(channel, log_time, &self.buffer)
    }
}
