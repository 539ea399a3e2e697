//! Layout file of a taxel array.

use super::grid::Grid;
use super::{Axes, TaxelError, TaxelUnit, TimeUnit};
use crate::math::direction_at;
use crate::sensor::fingertip::layout::{ElementLayout, SensingElement};
use crate::sensor::fingertip::made_for::{CalibrationTarget, LengthUnit};
use crate::sensor::skin::SerialConfig;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Supported version of the taxel layout file.
pub const TAXEL_LAYOUT_VERSION: u32 = 1;

/// Description of a taxel array: its columns, positions, axes and units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TaxelLayout {
    /// Version of the file, [`TAXEL_LAYOUT_VERSION`].
    pub version: u32,
    /// Name of the array.
    pub name: String,
    /// Description of the array, in one line.
    #[serde(default)]
    pub description: String,
    /// Unit of the columns.
    pub unit: TaxelUnit,
    /// Counts per newton in the columns x, y and z, for taxels that do not specify them. If neither is set, forces are
    /// in counts. Only with [`unit`](Self::unit) `counts`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub counts_per_newton: Option<[f64; 3]>,
    /// Rows per second. Used if there is no time column and no rate is given when the table is opened.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rate: Option<f64>,
    /// Names of the columns.
    pub columns: ColumnNames,
    /// Assignment of a taxel's axes to its columns.
    #[serde(default)]
    pub axes: Axes,
    /// Source of the zero of each column.
    #[serde(default)]
    pub zero: ZeroConfig,
    /// Rule for measuring the zero again; `None` to measure it only once per sequence.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rezero: Option<ZeroRule>,
    /// Slow drift correction of the zero; `None` to disable it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drift: Option<TaxelDrift>,
    /// `true` to subtract the mean reading of all taxels from each, which rejects uniform magnetic fields. Requires at
    /// least three taxels with the same normal.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub common_mode: bool,
    /// Protocol in which the array sends its readings over a serial port; `None` if they are available only as a table.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub serial: Option<SerialConfig>,
    /// The taxels in order of their numbers: element i is the i-th taxel.
    #[serde(rename = "taxel")]
    pub taxels: Vec<Taxel>,
}

/// Names of the columns of the table. In `x`, `y` and `z`, `{n}` is replaced by the taxel's number and `{prefix}` by
/// the array's prefix.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ColumnNames {
    /// Name of a taxel's column x, as in `txl{n}_x`.
    pub x: String,
    /// Name of a taxel's column y.
    pub y: String,
    /// Name of a taxel's column z.
    pub z: String,
    /// Prefix that distinguishes this array's columns from those of other arrays in the same table.
    #[serde(default)]
    pub prefix: String,
    /// Number of the first taxel.
    #[serde(default)]
    pub first: u32,
    /// Time column; if `None`, rows have a fixed rate.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<TimeColumn>,
    /// Column whose value changes when a new sequence starts. Each sequence starts without load.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sequence: Option<String>,
    /// Separator between cells; if `None`, a comma, a semicolon or a tab, detected from the header.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub delimiter: Option<char>,
    /// All columns of a table without a header, in order. A run of names with `{n}` is repeated for every taxel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub without_header: Option<Vec<String>>,
}

/// Time column.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimeColumn {
    /// Name of the column.
    pub column: String,
    /// Unit of the column.
    pub unit: TimeUnit,
}

/// Source of the zero: the values of the columns without load.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ZeroConfig {
    /// Number of unloaded rows at the start of each sequence, whose mean is the zero. During these rows, the zero is
    /// the mean so far. If 0, the zero is [`Taxel::zero`], or 0.
    pub rows: u32,
}

/// Rule for measuring the zero again after a time without contact and motion: it becomes the mean of the values during
/// that time.
///
/// A constant press that is weaker than [`untouched`](Self::untouched) becomes part of the zero.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ZeroRule {
    /// Duration without contact and motion, s.
    pub after: f64,
    /// Maximum magnitude of the reading of an untouched taxel, N (or counts if forces are in counts).
    pub untouched: f64,
    /// Maximum change of each component of a taxel's reading during that time, N (or counts).
    pub still: f64,
}

/// Slow drift correction of the zero while no taxel of the array is touched.
///
/// Drift beyond [`untouched`](Self::untouched) is indistinguishable from contact and is not corrected. A press that is
/// weaker and slower than [`time_constant`](Self::time_constant) is mistaken for drift, up to [`most`](Self::most).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TaxelDrift {
    /// Maximum magnitude of the reading of an untouched taxel, N (or counts if forces are in counts).
    pub untouched: f64,
    /// Time constant of the correction, s.
    pub time_constant: f64,
    /// Duration after a contact without correction, because the skin still creeps, s.
    #[serde(default = "one_second")]
    pub settle: f64,
    /// Maximum total correction of each force component of a taxel (N, or counts).
    pub most: f64,
}

fn one_second() -> f64 {
    1.0
}

/// One taxel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Taxel {
    /// Position of the taxel, m in the fingertip frame `T`.
    pub place: [f64; 3],
    /// Outward normal in `T`; its length does not matter.
    #[serde(default = "along_x")]
    pub normal: [f64; 3],
    /// Rotation of the taxel's x axis about the normal, relative to x of the element's frame `E_i`
    /// ([`SensingElement::facing`]: along y of `T` if the normal is along x), in degrees, counterclockwise when looking
    /// at the skin from outside.
    #[serde(default)]
    pub turn_deg: f64,
    /// Counts per newton in the columns x, y and z; `None` for those of the layout.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub counts_per_newton: Option<[f64; 3]>,
    /// Values of the columns x, y and z without load, in the unit of the columns. Set for all taxels or for none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub zero: Option<[f64; 3]>,
}

fn along_x() -> [f64; 3] {
    [1.0, 0.0, 0.0]
}

impl Taxel {
    /// Creates a taxel at `place` whose normal is along x of `T`.
    pub(super) fn at(place: [f64; 3]) -> Self {
        Self {
            place,
            normal: along_x(),
            turn_deg: 0.0,
            counts_per_newton: None,
            zero: None,
        }
    }

    /// Returns the sensing element of the taxel, with its outward normal and frame `E_i`.
    pub fn element(&self) -> SensingElement {
        SensingElement::facing(DVec3::from_array(self.normal).normalize_or(DVec3::X))
    }
}

impl TaxelLayout {
    /// Parses a layout from TOML. A table `[grid]` with `rows`, `columns` and `pitch` (m) may replace the taxels of a
    /// regular matrix.
    ///
    /// # Errors
    /// If the text is not a taxel layout of the supported version, or if values are out of range (all are listed).
    pub fn from_toml(text: &str) -> Result<Self, TaxelError> {
        #[derive(Deserialize)]
        struct VersionOnly {
            version: u32,
        }
        let VersionOnly { version } = toml::from_str(text)?;
        if version != TAXEL_LAYOUT_VERSION {
            return Err(TaxelError::Version { actual: version });
        }
        let layout: Self = match Grid::of(text)? {
            Some((grid, mut others)) => {
                others.insert("taxel".into(), toml::Value::try_from(grid.taxels())?);
                others.try_into()?
            }
            None => toml::from_str(text)?,
        };
        layout.check()?;
        Ok(layout)
    }

    /// Formats the layout as TOML.
    ///
    /// # Errors
    /// If a value cannot be represented in TOML.
    pub fn to_toml(&self) -> Result<String, TaxelError> {
        Ok(toml::to_string(self)?)
    }

    /// Identifies the array in calibrations: units, axes, common mode and taxels, but neither columns nor zeros.
    ///
    /// # Errors
    /// If a value cannot be represented in TOML.
    pub fn calibration_target(&self) -> Result<CalibrationTarget, TaxelError> {
        #[derive(Serialize)]
        struct Identity {
            kind: &'static str,
            unit: TaxelUnit,
            axes: Axes,
            #[serde(skip_serializing_if = "std::ops::Not::not")]
            common_mode: bool,
            scales: Vec<[f64; 3]>,
            places: Vec<([f64; 3], [f64; 3], f64)>,
        }
        let taxels = self.taxels.iter();
        let text = toml::to_string(&Identity {
            kind: "taxels",
            unit: self.unit,
            axes: self.axes,
            common_mode: self.common_mode,
            scales: taxels.clone().filter_map(|t| self.scale(t)).collect(),
            places: taxels.map(|t| (t.place, t.normal, t.turn_deg)).collect(),
        })?;
        let count = self.taxels.len();
        Ok(CalibrationTarget::layout(&text, count, LengthUnit::Metre))
    }

    /// Converts a vector in the frame of a taxel's element to its columns x, y and z, in the unit of the columns. NaN
    /// if there is no such taxel. Inverts the axes and the rotation of the taxel.
    pub fn in_columns(&self, taxel: usize, vector: DVec3) -> DVec3 {
        let turn = self.taxels.get(taxel).map_or(f64::NAN, |t| t.turn_deg);
        let turn = direction_at(turn.to_radians());
        self.axes.in_columns(turn, vector)
    }

    /// Unit of the resulting forces: newtons, or counts if the scale is unknown.
    pub fn force_unit(&self) -> TaxelUnit {
        let all = self.taxels.iter().all(|t| self.scale(t).is_some());
        match self.unit {
            TaxelUnit::Newton => TaxelUnit::Newton,
            TaxelUnit::Counts if all => TaxelUnit::Newton,
            TaxelUnit::Counts => TaxelUnit::Counts,
        }
    }

    /// Counts per newton of a taxel, or `None` if unknown.
    pub(super) fn scale(&self, taxel: &Taxel) -> Option<[f64; 3]> {
        taxel.counts_per_newton.or(self.counts_per_newton)
    }

    /// Elements with their positions, m in `T`.
    pub fn elements(&self) -> impl Iterator<Item = (SensingElement, DVec3)> + '_ {
        let taxels = self.taxels.iter();
        taxels.map(|taxel| (taxel.element(), DVec3::from_array(taxel.place)))
    }

    /// Element layout for control laws and tasks. Its frames are exact. Since elements of an [`ElementLayout`] lie on a
    /// dome around the origin of `T`, its radius is the mean distance of the taxels from the origin.
    pub fn element_layout(&self) -> ElementLayout {
        let count = self.taxels.len().max(1) as f64;
        let distances = self.elements().map(|(_, place)| place.length());
        ElementLayout {
            dome_radius: distances.sum::<f64>() / count,
            elements: self.elements().map(|(element, _)| element).collect(),
        }
    }
}
