//! The layout file of a taxel array.

use super::{Axes, TaxelError, TaxelUnit, TimeUnit};
use crate::sensor::layout::{ElementLayout, SensingElement};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Version of the taxel layout file that this program reads.
pub const TAXEL_LAYOUT_VERSION: u32 = 1;

/// A taxel array: its columns, places, axes and units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TaxelLayout {
    /// Version of the file, [`TAXEL_LAYOUT_VERSION`].
    pub version: u32,
    /// What the array is called.
    pub name: String,
    /// What it is, in a line.
    #[serde(default)]
    pub description: String,
    /// Unit of the columns.
    pub unit: TaxelUnit,
    /// Counts in the columns x, y and z for one newton, of every taxel that does not say otherwise. Where
    /// neither says it, forces are in counts. Only with [`unit`](Self::unit) `counts`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub counts_per_newton: Option<[f64; 3]>,
    /// Rows per second, where no column has the time and nobody says otherwise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rate: Option<f64>,
    /// The columns.
    pub columns: ColumnNames,
    /// How the axes of a taxel stand in its columns.
    #[serde(default)]
    pub axes: Axes,
    /// What the columns hold without load.
    #[serde(default)]
    pub zero: ZeroConfig,
    /// Slow correction of that; none unless the file has it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drift: Option<TaxelDrift>,
    /// The taxels, in the order of their numbers: element i is the i-th.
    #[serde(rename = "taxel")]
    pub taxels: Vec<Taxel>,
}

/// Names of columns. In `x`, `y` and `z`, `{n}` stands for the taxel's number and `{prefix}` for the array's prefix.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ColumnNames {
    /// The column x of a taxel, as in `txl{n}_x`.
    pub x: String,
    /// Its column y.
    pub y: String,
    /// Its column z.
    pub z: String,
    /// What tells this array's columns from those of another array in the same table.
    #[serde(default)]
    pub prefix: String,
    /// Number of the first taxel.
    #[serde(default)]
    pub first: u32,
    /// The column of the time; without one, rows are taken at a rate.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<TimeColumn>,
    /// The column whose value changes where another sequence begins, without load again.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sequence: Option<String>,
    /// What stands between two cells; without it, a comma, a semicolon or a tab, whichever the header has.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub delimiter: Option<char>,
    /// All columns of a table that has no header, in order; those with `{n}` one after the other are there for
    /// every taxel in turn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub without_header: Option<Vec<String>>,
}

/// The column of the time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimeColumn {
    /// Its name.
    pub column: String,
    /// Its unit.
    pub unit: TimeUnit,
}

/// How it is known what the columns hold without load.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ZeroConfig {
    /// Rows without load at the beginning of each sequence, whose mean is taken; 0: none, and the zero is what
    /// [`Taxel::zero`] says, or 0. In these rows, the mean of those so far is taken.
    pub rows: u32,
}

/// Slow correction of the zero, while no taxel of the array is touched.
///
/// Where drift has gone beyond [`untouched`](Self::untouched), it looks like a touch and is followed no more. A press
/// that is weaker than that and slower than [`time_constant`](Self::time_constant) is taken for drift, up to
/// [`most`](Self::most).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TaxelDrift {
    /// Length of a reading up to which its taxel counts as untouched, N (counts where forces are in counts).
    pub untouched: f64,
    /// Time in which the zero goes 63 % of its way to the newest row, s.
    pub time_constant: f64,
    /// Time after a touch in which nothing is corrected, as the skin still creeps, s.
    #[serde(default = "one_second")]
    pub settle: f64,
    /// Most that is corrected in all of each of a taxel's columns, N (counts).
    pub most: f64,
}

fn one_second() -> f64 {
    1.0
}

/// One taxel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Taxel {
    /// Where it is, m in the fingertip frame `T`.
    pub place: [f64; 3],
    /// Its outward normal in `T`, of any length.
    #[serde(default = "along_x")]
    pub normal: [f64; 3],
    /// By how much its x is turned about the normal from x of the element's frame `E_i`
    /// ([`SensingElement::facing`]: along y of `T` where the normal is along x), counterclockwise for who looks at the
    /// skin from outside, degrees.
    #[serde(default)]
    pub turn_deg: f64,
    /// Counts in its columns x, y and z for one newton.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub counts_per_newton: Option<[f64; 3]>,
    /// What its columns x, y and z hold without load, in their unit. All taxels say it, or none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub zero: Option<[f64; 3]>,
}

fn along_x() -> [f64; 3] {
    [1.0, 0.0, 0.0]
}

impl Taxel {
    /// The element's outward normal and the rest of its frame `E_i`.
    pub fn element(&self) -> SensingElement {
        SensingElement::facing(DVec3::from_array(self.normal).normalize_or(DVec3::X))
    }
}

impl TaxelLayout {
    /// Reads a layout from the text of its file.
    ///
    /// # Errors
    /// When the text is no taxel layout of this version, or values are out of range: all of them are named.
    pub fn from_toml(text: &str) -> Result<Self, TaxelError> {
        #[derive(Deserialize)]
        struct VersionOnly {
            version: u32,
        }
        let VersionOnly { version } = toml::from_str(text)?;
        if version != TAXEL_LAYOUT_VERSION {
            return Err(TaxelError::Version { actual: version });
        }
        let layout: Self = toml::from_str(text)?;
        layout.check()?;
        Ok(layout)
    }

    /// The text of the layout's file.
    ///
    /// # Errors
    /// When a value has no form in TOML.
    pub fn to_toml(&self) -> Result<String, TaxelError> {
        Ok(toml::to_string(self)?)
    }

    /// Unit of the forces that come of it: newtons, unless counts are all that is known.
    pub fn force_unit(&self) -> TaxelUnit {
        let all = self.taxels.iter().all(|t| self.scale(t).is_some());
        match self.unit {
            TaxelUnit::Newton => TaxelUnit::Newton,
            TaxelUnit::Counts if all => TaxelUnit::Newton,
            TaxelUnit::Counts => TaxelUnit::Counts,
        }
    }

    /// Counts per newton of a taxel, where they are known.
    pub(super) fn scale(&self, taxel: &Taxel) -> Option<[f64; 3]> {
        taxel.counts_per_newton.or(self.counts_per_newton)
    }

    /// Each element with its place, m in `T`.
    pub fn elements(&self) -> impl Iterator<Item = (SensingElement, DVec3)> + '_ {
        let taxels = self.taxels.iter();
        taxels.map(|taxel| (taxel.element(), DVec3::from_array(taxel.place)))
    }

    /// The elements as laws and tasks take them. Their frames are exact; as they must lie on a dome about the origin
    /// of `T`, their tips are taken to be at the mean distance of the taxels from it, each along its normal.
    pub fn element_layout(&self) -> ElementLayout {
        let count = self.taxels.len().max(1) as f64;
        let distances = self.elements().map(|(_, place)| place.length());
        ElementLayout {
            dome_radius: distances.sum::<f64>() / count,
            elements: self.elements().map(|(element, _)| element).collect(),
        }
    }
}
