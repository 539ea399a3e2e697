//! A self-describing message of a tactile sensor, and its conversion to and from other messages.
//!
//! [`TactileArray`] contains the geometry, units, axes, rate and validity that a reader needs in addition to the values.
//! The conversions document what is lost.

mod cloud;
mod message;
mod recorded;
mod wrench;

pub use cloud::{from_cloud, to_cloud};
pub use message::{
    CALIBRATED, CONTACT, ELEMENT_AXES, INVALID, NOMINAL, OVERLOAD, SATURATED, SENSOR_AXES, SLIP,
    STALE, TactileArray, TactileChannel, UNCALIBRATED, names,
};
pub use recorded::{of_finger, set_recorded, to_recorded};
pub use wrench::{from_wrench, to_wrench};

use crate::ros::Header;
use glam::{DQuat, DVec3};

/// Maximum deviation of a quaternion's squared length from 1.
const UNIT_TOLERANCE: f64 = 1e-3;

/// Error in a [`TactileArray`], or in a message that is converted to one.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ArrayError {
    /// A list does not have one entry per element, or per element and component.
    #[error("expected {expected} entries in {list}, got {actual}")]
    Count {
        /// Name of the list with the wrong length.
        list: String,
        /// Expected number of entries.
        expected: usize,
        /// Actual number of entries.
        actual: usize,
    },
    /// A channel is missing, or has other components, another unit or unknown axes.
    #[error("expected {expected}, got {actual}")]
    Channel {
        /// Description of the expected channel.
        expected: &'static str,
        /// Description of the actual channel.
        actual: String,
    },
    /// A position is not finite, or an orientation is not a unit quaternion.
    #[error("expected a finite position and a unit quaternion of element {element}, got {actual}")]
    Pose {
        /// Index of the element.
        element: usize,
        /// Description of the actual pose.
        actual: String,
    },
    /// A cloud has no valid field of this name.
    #[error("expected a cloud with the float field {0} within each point, got none")]
    Field(&'static str),
    /// A cloud is big-endian.
    #[error("expected a cloud of little-endian numbers, got big-endian ones")]
    BigEndian,
}

impl TactileArray {
    /// Array without elements, for a sensor that is only known by its `header`. The sensor's name is that of its frame.
    pub fn unknown(header: &Header) -> Self {
        Self {
            header: header.clone(),
            sensor: header.frame_id.clone(),
            rate: f64::NAN,
            contact_threshold: f64::NAN,
            slip_threshold: f64::NAN,
            overload_threshold: f64::NAN,
            ..Self::default()
        }
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.positions.len()
    }

    /// The channel with this name, if any.
    pub fn channel(&self, name: &str) -> Option<&TactileChannel> {
        self.channels.iter().find(|channel| channel.name == name)
    }

    /// Checks that all lists match, and that positions and orientations are valid.
    ///
    /// # Errors
    /// For the first list or pose that is invalid.
    pub fn check(&self) -> Result<(), ArrayError> {
        let elements = self.elements();
        count("orientations", elements, self.orientations.len())?;
        optional("areas", elements, self.areas.len())?;
        optional("contact", elements, self.contact.len())?;
        for channel in &self.channels {
            let list = |list| format!("{list} of the channel {:?}", channel.name);
            let values = elements.saturating_mul(channel.components.into());
            count(&list("values"), values, channel.values.len())?;
            optional(&list("variances"), values, channel.variances.len())?;
            optional(&list("status"), elements, channel.status.len())?;
        }
        let poses = self.positions.iter().zip(&self.orientations);
        for (element, (&position, &orientation)) in poses.enumerate() {
            let rotation = DQuat::from(orientation);
            let is_unit = (rotation.length_squared() - 1.0).abs() <= UNIT_TOLERANCE;
            if !(is_unit && DVec3::from(position).is_finite()) {
                let actual = format!("{position:?} and {orientation:?}");
                return Err(ArrayError::Pose { element, actual });
            }
        }
        Ok(())
    }

    /// Force on each element by the touched object (N), in the axes of the header's frame, or NaN if it is unknown or
    /// invalid.
    ///
    /// # Errors
    /// If the array is invalid or has no forces in newtons.
    pub fn forces(&self) -> Result<Vec<DVec3>, ArrayError> {
        self.check()?;
        let channel = self.force_channel()?;
        let rotation = |element: usize| match channel.axes {
            SENSOR_AXES => DQuat::IDENTITY,
            _ => DQuat::from(self.orientations[element]).normalize(),
        };
        let forces = channel.vectors().enumerate();
        Ok(forces
            .map(|(element, force)| rotation(element) * force)
            .collect())
    }

    /// Force on each element by the touched object (N), in the axes of the element's frame, or NaN if it is unknown or
    /// invalid.
    ///
    /// # Errors
    /// If the array is invalid or has no forces in newtons.
    pub fn forces_in_element_frames(&self) -> Result<Vec<DVec3>, ArrayError> {
        self.check()?;
        let channel = self.force_channel()?;
        let turned = |(element, force): (usize, DVec3)| match channel.axes {
            SENSOR_AXES => {
                DQuat::from(self.orientations[element])
                    .normalize()
                    .inverse()
                    * force
            }
            _ => force,
        };
        Ok(channel.vectors().enumerate().map(turned).collect())
    }

    fn force_channel(&self) -> Result<&TactileChannel, ArrayError> {
        let expected = "a channel \"force\" of three components in N, in axes 0 or 1";
        let wrong = |actual| ArrayError::Channel { expected, actual };
        let channel = self.channel(names::FORCE);
        let channel = channel.ok_or_else(|| wrong("no channel of this name".into()))?;
        let TactileChannel {
            components,
            axes,
            unit,
            ..
        } = channel;
        match (components, unit.as_str(), *axes) {
            (3, "N", ELEMENT_AXES | SENSOR_AXES) => Ok(channel),
            _ => Err(wrong(format!(
                "{components} components in {unit:?}, in axes {axes}"
            ))),
        }
    }
}

impl TactileChannel {
    /// Channel of forces (N) in the header's axes, without values. Their calibration is unknown.
    pub fn of_forces() -> Self {
        Self {
            name: names::FORCE.into(),
            unit: "N".into(),
            axes: SENSOR_AXES,
            components: 3,
            calibration: NOMINAL,
            minimum: f64::NAN,
            maximum: f64::NAN,
            ..Self::default()
        }
    }

    /// Vectors of the elements; NaN if invalid. Empty unless the channel has three components.
    fn vectors(&self) -> impl Iterator<Item = DVec3> + '_ {
        let values = match self.components {
            3 => &self.values[..],
            _ => &[],
        };
        let vectors = values.chunks_exact(3).map(DVec3::from_slice);
        vectors.enumerate().map(|(element, vector)| {
            let status = self.status.get(element).copied().unwrap_or_default();
            match status & INVALID {
                0 => vector,
                _ => DVec3::NAN,
            }
        })
    }
}

fn count(list: &str, expected: usize, actual: usize) -> Result<(), ArrayError> {
    match actual == expected {
        true => Ok(()),
        false => Err(ArrayError::Count {
            list: list.into(),
            expected,
            actual,
        }),
    }
}

/// Like [`count`], for a list that may be empty.
fn optional(list: &str, expected: usize, actual: usize) -> Result<(), ArrayError> {
    match actual {
        0 => Ok(()),
        actual => count(list, expected, actual),
    }
}

#[cfg(test)]
mod tests;
