//! Units and axes of a taxel array's columns.

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

/// Unit of a taxel's readings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum TaxelUnit {
    /// Raw counts of unknown scale.
    #[serde(rename = "counts")]
    Counts,
    /// Newtons.
    #[serde(rename = "N")]
    Newton,
}

impl TaxelUnit {
    /// Name in files: `counts` or `N`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Counts => "counts",
            Self::Newton => "N",
        }
    }
}

/// Unit of a time column.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TimeUnit {
    /// Seconds.
    S,
    /// Milliseconds.
    Ms,
    /// Microseconds.
    Us,
    /// Nanoseconds.
    Ns,
}

impl TimeUnit {
    /// Name in files: `s`, `ms`, `us` or `ns`.
    pub fn name(self) -> &'static str {
        match self {
            Self::S => "s",
            Self::Ms => "ms",
            Self::Us => "us",
            Self::Ns => "ns",
        }
    }

    /// Duration of the unit, s.
    pub fn seconds(self) -> f64 {
        match self {
            Self::S => 1.0,
            Self::Ms => 1e-3,
            Self::Us => 1e-6,
            Self::Ns => 1e-9,
        }
    }
}

/// Assignment of a taxel's axes to its columns: x and y tangential, z compression, positive when pressed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Axes {
    /// Column and sign of the taxel's x axis.
    pub x: SignedAxis,
    /// Column and sign of the taxel's y axis.
    pub y: SignedAxis,
    /// Column and sign of the taxel's z axis.
    pub z: SignedAxis,
}

impl Default for Axes {
    fn default() -> Self {
        Self {
            x: SignedAxis::X,
            y: SignedAxis::Y,
            z: SignedAxis::Z,
        }
    }
}

impl Axes {
    /// Converts a vector from the columns x, y, z to the taxel's axes.
    pub fn apply(&self, columns: DVec3) -> DVec3 {
        let along = |axis: SignedAxis| axis.sign() * columns[axis.column()];
        DVec3::new(along(self.x), along(self.y), along(self.z))
    }

    /// Converts a vector from the taxel's axes to the columns x, y, z: the inverse of [`apply`](Self::apply).
    pub fn undo(&self, own: DVec3) -> DVec3 {
        let mut columns = DVec3::ZERO;
        for (axis, value) in [self.x, self.y, self.z].into_iter().zip(own.to_array()) {
            columns[axis.column()] = axis.sign() * value;
        }
        columns
    }

    /// Converts a vector from the frame of an element to the columns x, y, z of its taxel. `turn` contains cosine and
    /// sine of the taxel's rotation.
    pub(super) fn in_columns(&self, turn: DVec2, vector: DVec3) -> DVec3 {
        let back = DVec2::new(turn.x, -turn.y);
        self.undo(back.rotate(vector.truncate()).extend(vector.z))
    }
}

/// One of the columns x, y, z, possibly negated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum SignedAxis {
    /// Column x.
    #[serde(rename = "x", alias = "+x")]
    X,
    /// Column y.
    #[serde(rename = "y", alias = "+y")]
    Y,
    /// Column z.
    #[serde(rename = "z", alias = "+z")]
    Z,
    /// Column x, negated.
    #[serde(rename = "-x")]
    MinusX,
    /// Column y, negated.
    #[serde(rename = "-y")]
    MinusY,
    /// Column z, negated.
    #[serde(rename = "-z")]
    MinusZ,
}

impl SignedAxis {
    /// Index of the column: 0 is x, 1 is y, 2 is z.
    pub fn column(self) -> usize {
        match self {
            Self::X | Self::MinusX => 0,
            Self::Y | Self::MinusY => 1,
            Self::Z | Self::MinusZ => 2,
        }
    }

    /// Sign of the column: 1 or -1.
    pub fn sign(self) -> f64 {
        match self {
            Self::X | Self::Y | Self::Z => 1.0,
            Self::MinusX | Self::MinusY | Self::MinusZ => -1.0,
        }
    }
}
