//! The wrench on a whole fingertip, from all elements together.
//!
//! Most laboratories have one force sensor under the whole fingertip and cannot load single elements. A wrench calibration learns from
//! pictures and what that sensor measured at the same time: ridge regression of each component on all elements' growth and
//! displacement ([`features`]), with penalty and terms chosen by cross-validation in blocks of time ([`mod@fit`]), judged on data that
//! no part of it has seen ([`quality`]). [`forces`] reads what was measured, [`calibration`] is the file, [`estimator`] predicts on the
//! control path, and [`sensor`] puts it behind a camera as a fingertip of one element.
//!
//! # Frame and sign
//!
//! A wrench is predicted in the frame in which it was measured, and of whatever sign. Where it has to mean something, in [`sensor`],
//! the force is that on the fingertip by what it touches, in a frame whose z axis points outward along the dome's axis.

mod blocks;
pub mod calibration;
mod choice;
pub mod error;
pub mod estimator;
pub mod features;
pub mod fit;
pub mod forces;
pub mod novelty;
pub mod quality;
pub mod recordings;
mod ridge;
pub mod sensor;
mod validation;

pub use calibration::{AxisModel, WrenchCalibration};
pub use error::WrenchError;
pub use estimator::{WrenchEstimate, WrenchEstimator};
pub use fit::{WrenchFit, WrenchSample, fit};
pub use sensor::WrenchSensor;

use super::table::Quantity;
use serde::{Deserialize, Serialize};

/// Number of components of a wrench.
pub const AXES: usize = 6;

/// A component of a wrench.
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
    /// Torque about x, N m.
    #[serde(rename = "m_x")]
    TorqueX,
    /// Torque about y, N m.
    #[serde(rename = "m_y")]
    TorqueY,
    /// Torque about z, N m.
    #[serde(rename = "m_z")]
    TorqueZ,
}

impl WrenchAxis {
    /// All components, in the order in which they are written.
    pub const ALL: [Self; AXES] = [
        Self::ForceX,
        Self::ForceY,
        Self::ForceZ,
        Self::TorqueX,
        Self::TorqueY,
        Self::TorqueZ,
    ];

    /// Place in [`Self::ALL`].
    pub fn index(self) -> usize {
        self as usize
    }

    /// Name of its column.
    pub fn name(self) -> &'static str {
        ["f_x", "f_y", "f_z", "m_x", "m_y", "m_z"][self as usize]
    }

    /// What it is of.
    pub fn quantity(self) -> Quantity {
        match self {
            Self::ForceX | Self::ForceY | Self::ForceZ => Quantity::Force,
            Self::TorqueX | Self::TorqueY | Self::TorqueZ => Quantity::Torque,
        }
    }

    /// Its unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::ForceX | Self::ForceY | Self::ForceZ => "N",
            Self::TorqueX | Self::TorqueY | Self::TorqueZ => "N m",
        }
    }
}

/// A measured wrench: forces in N, torques in N m, none where one was not measured.
pub type MeasuredWrench = [Option<f64>; AXES];
