//! Wrench on a whole fingertip, estimated from all elements together.
//!
//! Most laboratories have one force sensor under the fingertip and cannot load individual elements. A wrench
//! calibration is fitted to images or taxel readings and simultaneous measurements of that sensor. Each component is a
//! ridge regression on features of all elements ([`moments`] of images, [`taxels`]), with terms and penalty chosen by
//! cross-validation over blocks of time ([`mod@fit`]), and evaluated on held-out data ([`quality`]). [`forces`] reads
//! the measurements, [`calibration`] defines the file, [`estimator`] estimates wrenches in the control loop, and
//! [`sensor`] combines it with a camera to a fingertip of one element.
//!
//! # Frame and sign
//!
//! A wrench is estimated in the frame and with the sign of the measurements. Only [`sensor`] requires a convention: the
//! force on the fingertip by the object, in a frame whose z axis points outward along the dome's axis.

pub mod basis;
mod blocks;
pub mod calibration;
mod choice;
pub mod error;
pub mod estimator;
pub mod fit;
pub mod forces;
mod learn;
mod model;
pub mod moments;
pub mod novelty;
pub mod passport;
mod presses;
pub mod quality;
pub mod recordings;
mod ridge;
mod sample;
pub mod sensor;
pub mod taxels;
pub mod transfer;
mod validation;
pub mod verification;

pub use calibration::{AxisModel, CalibrationOf, WrenchCalibration};
pub use error::WrenchError;
pub use estimator::{EstimatorOf, WrenchEstimate, WrenchEstimator};
pub use fit::{FitOf, fit};
pub use sample::{SampleOf, WrenchSample};
pub use sensor::WrenchSensor;

use super::table::Quantity;
use serde::{Deserialize, Serialize};

/// Number of components of a wrench, including the place of contact.
pub const AXES: usize = 8;

/// A component of a wrench, or of the place of contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WrenchAxis {
    /// Force along x, N.
    #[serde(rename = "f_x")]
    ForceX,
    /// Force along y, N.
    #[serde(rename = "f_y")]
    ForceY,
    /// Force along z, N.
    #[serde(rename = "f_z")]
    ForceZ,
    /// Torque about x, N·m.
    #[serde(rename = "m_x")]
    TorqueX,
    /// Torque about y, N·m.
    #[serde(rename = "m_y")]
    TorqueY,
    /// Torque about z, N·m.
    #[serde(rename = "m_z")]
    TorqueZ,
    /// Place of contact along x, m.
    #[serde(rename = "p_x")]
    PlaceX,
    /// Place of contact along y, m.
    #[serde(rename = "p_y")]
    PlaceY,
}

impl WrenchAxis {
    /// All components, in the order of calibration files.
    pub const ALL: [Self; AXES] = [
        Self::ForceX,
        Self::ForceY,
        Self::ForceZ,
        Self::TorqueX,
        Self::TorqueY,
        Self::TorqueZ,
        Self::PlaceX,
        Self::PlaceY,
    ];

    /// Index of the component in [`Self::ALL`].
    pub fn index(self) -> usize {
        self as usize
    }

    /// Name of the component in tables, such as `f_x`.
    pub fn name(self) -> &'static str {
        ["f_x", "f_y", "f_z", "m_x", "m_y", "m_z", "p_x", "p_y"][self as usize]
    }

    /// Physical quantity of the component.
    pub fn quantity(self) -> Quantity {
        match self {
            Self::ForceX | Self::ForceY | Self::ForceZ => Quantity::Force,
            Self::TorqueX | Self::TorqueY | Self::TorqueZ => Quantity::Torque,
            Self::PlaceX | Self::PlaceY => Quantity::Length,
        }
    }

    /// Unit for reports, and the factor that converts to it from [`unit`](Self::unit): places are reported in mm.
    pub fn shown_unit(self) -> (&'static str, f64) {
        match self {
            Self::PlaceX | Self::PlaceY => ("mm", 1e3),
            axis => (axis.unit(), 1.0),
        }
    }

    /// SI unit of the component.
    pub fn unit(self) -> &'static str {
        match self {
            Self::ForceX | Self::ForceY | Self::ForceZ => "N",
            Self::TorqueX | Self::TorqueY | Self::TorqueZ => "N m",
            Self::PlaceX | Self::PlaceY => "m",
        }
    }
}

/// A measured wrench: forces in N, torques in N·m and the place of contact in m, `None` for components that were not measured.
pub type MeasuredWrench = [Option<f64>; AXES];
