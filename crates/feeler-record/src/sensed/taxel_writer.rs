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
    /// `true` if wrenches of a calibration are written, too ([`TaxelWriter::write_wrench`]).
    pub wrenches: bool,
}

/// Writes [`Tactile`] frames to [`TACTILE`], and messages for viewers: taxels and forces as a point cloud, taxels as
/// dots of a scene and, if forces are in newtons, their sum as a wrench. All are in the frame of finger 0's dome, `T`.
///
/// Until [`finish`](Self::finish) is called, the file lacks its end, which MCAP readers report.
pub struct TaxelWriter {
    messages: SensedWriter,
    elements: Elements,
    cloud: PointCloud2,
    scene: MarkerArray,
    /// `None` if forces are not in newtons.
    wrench: Option<WrenchStamped>,
    /// Stamp of the latest cloud (s).
    drawn: Option<f64>,
}

impl TaxelWriter {
    /// Creates the file.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn create(path: &Path, facts: TaxelFacts) -> Result<Self, RecordError> {
        let mut container = Container::create(path, WriteOptions::new())?;
        let (is_newton, wrenches) = (facts.unit == "N", facts.wrenches);
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
        channels.extend(wrenches.then(|| Channel::from(WRENCH)));
        Ok(Self {
            // All topics are of the rig or of finger 0.
            messages: SensedWriter::in_container(container, channels, 1)?,
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
    /// If the file cannot be written, or the stamp is not a valid time (negative or not finite).
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
        // Also written if time jumps back.
        let due = (self.drawn).is_none_or(|drawn| (frame.stamp - drawn).abs() >= FRAME_TIME);
        if due {
            self.drawn = Some(frame.stamp);
            self.cloud.header.stamp = stamp;
            self.elements.fill(&mut self.cloud, |_| false);
            self.messages.write(topics::taxels(0), &self.cloud)?;
        }
        Ok(())
    }

    /// Writes a wrench to [`WRENCH`]. Requires [`TaxelFacts::wrenches`].
    ///
    /// # Errors
    /// If the file cannot be written, or was created without wrenches.
    pub fn write_wrench(&mut self, wrench: &WrenchStamped) -> Result<(), RecordError> {
        self.messages.write(WRENCH, wrench)
    }

    /// Passes buffered messages to the operating system.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn flush(&mut self) -> Result<(), RecordError> {
        self.messages.flush()
    }

    /// Writes the end of the file and closes it.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn finish(self) -> Result<(), RecordError> {
        self.messages.finish()
    }
}
