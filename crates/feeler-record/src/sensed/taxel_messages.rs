//! Recordings of third-party taxel arrays without a run: one MCAP file of ROS 2 messages.

use super::readings::{SensedWriter, TACTILE, WRENCH};
use crate::error::RecordError;
use crate::messages::channels::Tactile;
use crate::messages::topic::{Channel, topics};
use crate::reading::container::Container;
use crate::ros::{MarkerArray, PointCloud2, Time, WrenchStamped};
use crate::sensed::taxels::{Elements, taxels};
use crate::viewers::scene::{FRAME_TIME, element_dots};
use crate::writing::memory::MessageSink;
use ::mcap::WriteOptions;
use feeler::sensor::fingertip::SensingElement;
use feeler::sensor::forces::TactileFrame;
use glam::DVec3;
use std::collections::BTreeMap;
use std::path::Path;

/// Name of the metadata record at the start of the file: name of the array, unit of its forces, and layout.
pub const TAXELS: &str = "feeler.taxels";

/// Constants of a taxel array.
#[derive(Debug, Clone)]
pub struct TaxelFacts {
    /// Name of the array.
    pub name: String,
    /// Unit of the forces: `N` or `counts`.
    pub unit: &'static str,
    /// Text of its layout file.
    pub layout: String,
    /// Elements, each with its position in the fingertip frame `T` (m).
    pub elements: Vec<(SensingElement, DVec3)>,
    /// `true` if wrenches of a calibration are written to [`WRENCH`], too.
    pub wrenches: bool,
}

impl TaxelFacts {
    fn is_newton(&self) -> bool {
        self.unit == "N"
    }
}

impl SensedWriter {
    /// Creates a file for [`TaxelMessages`], and for wrenches of a calibration if [`TaxelFacts::wrenches`] is `true`.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn create_for_taxels(path: &Path, facts: &TaxelFacts) -> Result<Self, RecordError> {
        let mut container = Container::create(path, WriteOptions::new())?;
        let metadata = [
            ("name", facts.name.as_str()),
            ("unit", facts.unit),
            ("layout", &facts.layout),
        ];
        let metadata = metadata.map(|(key, value)| (key.to_owned(), value.to_owned()));
        container.metadata(TAXELS, BTreeMap::from(metadata))?;
        let mut channels: Vec<Channel> = vec![
            TACTILE.into(),
            topics::taxels(0).into(),
            topics::SCENE.into(),
        ];
        channels.extend(facts.is_newton().then(|| Channel::from(topics::wrench(0))));
        channels.extend(facts.wrenches.then(|| Channel::from(WRENCH)));
        // All topics are of the rig or of finger 0.
        Self::in_container(container, channels, 1)
    }
}

/// Writes [`Tactile`] frames to [`TACTILE`], and messages for viewers: taxels and forces as a point cloud, taxels as
/// dots of a scene and, if forces are in newtons, their sum as a wrench. All are in the frame of finger 0's dome, `T`.
pub struct TaxelMessages {
    elements: Elements,
    cloud: PointCloud2,
    scene: MarkerArray,
    /// `None` if forces are not in newtons.
    wrench: Option<WrenchStamped>,
    /// Stamp of the latest cloud (s).
    drawn: Option<f64>,
}

impl TaxelMessages {
    /// Creates the messages of an array.
    pub fn new(facts: &TaxelFacts) -> Self {
        let elements = Elements::new(facts.elements.clone());
        let cloud = taxels(0, &elements);
        let wrench = facts.is_newton().then(|| WrenchStamped {
            header: cloud.header.clone(),
            ..WrenchStamped::default()
        });
        Self {
            scene: MarkerArray {
                markers: vec![element_dots(elements.tips())],
            },
            elements,
            cloud,
            wrench,
            drawn: None,
        }
    }

    /// Writes a frame to a file created with [`SensedWriter::create_for_taxels`].
    ///
    /// # Errors
    /// If the file cannot be written, or the stamp is not a valid time (negative or not finite).
    pub fn write(
        &mut self,
        frame: &TactileFrame,
        writer: &mut SensedWriter,
    ) -> Result<(), RecordError> {
        let forces = frame.forces.iter().map(|&force| force.into());
        let tactile = Tactile {
            sequence: frame.sequence,
            stamp: frame.stamp,
            forces: forces.collect(),
        };
        writer.write(TACTILE, &tactile)?;
        let Some(stamp) = Time::of(frame.stamp) else {
            return Ok(());
        };
        self.elements.take_forces(&frame.forces);
        if let Some(wrench) = &mut self.wrench {
            wrench.header.stamp = stamp;
            wrench.wrench = self.elements.wrench();
            writer.write(topics::wrench(0), wrench)?;
        }
        if self.drawn.is_none() {
            for marker in &mut self.scene.markers {
                marker.header.stamp = stamp;
            }
            writer.write(topics::SCENE, &self.scene)?;
        }
        // Also written if time jumps back.
        let due = (self.drawn).is_none_or(|drawn| (frame.stamp - drawn).abs() >= FRAME_TIME);
        if due {
            self.drawn = Some(frame.stamp);
            self.cloud.header.stamp = stamp;
            self.elements.fill(&mut self.cloud, |_| false);
            writer.write(topics::taxels(0), &self.cloud)?;
        }
        Ok(())
    }
}
