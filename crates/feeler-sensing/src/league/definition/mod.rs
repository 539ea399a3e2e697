//! Definitions of data sets: TOML files with the origin, format and split of the data, and published results.

mod check;

use serde::Deserialize;
use std::path::PathBuf;

/// Error in a definition.
#[derive(Debug, thiserror::Error)]
pub enum DefinitionError {
    /// The text is not a definition.
    #[error("{0}")]
    Toml(#[from] toml::de::Error),
    /// A value is out of range.
    #[error("{key}: expected {expected}, got {actual}")]
    Value {
        /// Key of the value.
        key: &'static str,
        /// Accepted values.
        expected: String,
        /// Value in the file.
        actual: String,
    },
}

/// Definition of a data set.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Definition {
    version: u32,
    /// Unique name: letters, digits, `-` and `_`.
    pub name: String,
    /// Description in one line.
    pub title: String,
    /// Folder of the data, relative to the file; for a built-in set, relative to the data folder.
    #[serde(default)]
    pub folder: PathBuf,
    /// Origin and version of the data.
    pub source: String,
    /// Licence of the data.
    pub licence: String,
    /// Split into training and test data.
    pub split: Split,
    /// Entries that were developed on these data, whose results are therefore optimistic.
    #[serde(default)]
    pub chosen_here: Vec<String>,
    /// Recordings labelled with slip. Either this or [`values`](Self::values) is given.
    pub slip: Option<SlipData>,
    /// Recordings with measured values.
    pub values: Option<ValuesData>,
    /// Published results.
    #[serde(default)]
    pub published: Vec<Published>,
}

/// Split into training and test data.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(tag = "by", rename_all = "snake_case", deny_unknown_fields)]
pub enum Split {
    /// Whole groups are left out: the k-th group by name is tested in fold k modulo `folds`. `folds` is at most the
    /// number of groups.
    Group {
        /// Number of folds.
        folds: usize,
    },
    /// The last part of each recording is tested after training on its beginning.
    Last {
        /// Fraction of the recording that is tested.
        part: f64,
    },
    /// Fold k tests the k-th contiguous block of each recording. A tenth of a block on each side is not used.
    Blocks {
        /// Number of folds.
        folds: usize,
    },
}

/// Recordings labelled with slip, with the options of `feeler score-slip`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SlipData {
    /// File or folder of the recordings; by default the folder of the data set.
    #[serde(default)]
    pub recordings: PathBuf,
    /// Table of labels.
    pub labels: Option<PathBuf>,
    /// Layout of a taxel array: a file or a built-in name.
    pub taxels: Option<String>,
    /// Prefixes of the columns of each array.
    #[serde(default)]
    pub prefixes: Vec<String>,
    /// Column whose value changes where the next recording begins.
    pub sequence: Option<String>,
    /// Names of the tables in each recording's folder.
    #[serde(default)]
    pub tables: Vec<String>,
    /// Layout of markers.
    pub layout: Option<PathBuf>,
    /// Frames per second, overriding any time column.
    pub rate: Option<f64>,
    /// `true` if recordings begin without contact.
    #[serde(default)]
    pub untouched: bool,
    /// Column of the labels that groups recordings.
    pub group: Option<String>,
    /// Name of the table of labels of frames in each recording's folder.
    pub frame_labels: Option<String>,
    /// `true` if accuracy is a metric, in addition to the area under the ROC curve.
    #[serde(default = "yes")]
    pub accuracy: bool,
}

fn yes() -> bool {
    true
}

/// Recordings with measured values.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ValuesData {
    /// Error metric of the results.
    pub metric: ErrorMetric,
    /// The measured values.
    pub targets: Vec<Target>,
    /// Tables of a taxel array. Either this or [`images`](Self::images) is given.
    pub taxels: Option<TaxelData>,
    /// Images.
    pub images: Option<ImageData>,
}

/// Error of predicted values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ErrorMetric {
    /// Root mean square error.
    Rmse,
    /// Mean absolute error.
    Mae,
}

impl ErrorMetric {
    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rmse => "rmse",
            Self::Mae => "mae",
        }
    }
}

/// A measured value.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Target {
    /// Name in results.
    pub name: String,
    /// Column of the table.
    pub column: String,
    /// Unit of the results.
    pub unit: String,
    /// Factor from the column's unit to [`unit`](Self::unit).
    #[serde(default = "one")]
    pub factor: f64,
    /// Minimum valid number in the column; a smaller one means that nothing was measured.
    pub at_least: Option<f64>,
}

fn one() -> f64 {
    1.0
}

/// Tables of a taxel array, each with a table of measured values.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TaxelData {
    /// Layout: a file, a built-in name, or the content of a layout file.
    pub layout: Layout,
    /// Prefix of the array's columns.
    pub prefix: Option<String>,
    /// File name of the tables; `*` matches any text, which is the name of the recording.
    pub tables: String,
    /// File name of the table of measured values; `*` matches the same text.
    pub targets: String,
    /// Time column (s) of the table of measured values, on the clock of the taxels.
    pub time: String,
    /// Names of all columns of the tables of measured values, if the tables have no header.
    pub without_header: Option<Vec<String>>,
}

/// Layout of a taxel array.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum Layout {
    /// A file or a built-in name.
    Named(String),
    /// The content of a layout file.
    Given(toml::Table),
}

/// Images listed in a table of measured values.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ImageData {
    /// Table of measured values.
    pub table: PathBuf,
    /// Column of the table with the names of the images.
    pub column: String,
    /// Folder to which the names are relative.
    #[serde(default)]
    pub folder: PathBuf,
    /// Images in which the elements are located.
    pub reference: Reference,
    /// Tracks markers that move by more than their spacing, instead of measuring moments in fixed regions.
    #[serde(default)]
    pub track: bool,
}

/// Images in which the elements are located.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum Reference {
    /// Mean of this number of images at the start of the table.
    First(usize),
    /// Mean of the images in these files.
    Files(Vec<PathBuf>),
}

/// A published result.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Published {
    /// Metric, named as in the results.
    pub metric: String,
    /// Value with its unit.
    pub value: String,
    /// Source, and the split used if it differs from this one.
    pub source: String,
}

impl Definition {
    /// Parses and checks a definition.
    ///
    /// # Errors
    /// If the text is invalid.
    pub fn from_toml(text: &str) -> Result<Self, DefinitionError> {
        let definition: Self = toml::from_str(text)?;
        definition.check()?;
        Ok(definition)
    }
}
