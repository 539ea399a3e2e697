//! Commercial and open three-axis taxel arrays as tactile sensors: uSkin, AnySkin, ReSkin, eFlesh, PapillArray.
//!
//! Readings come as a table with one row per sample, from a file or a live stream. A [`TaxelLayout`] (TOML) defines the
//! columns of each taxel, the positions and axes of the taxels, and the unit. [`TaxelSensor`] reads the rows and
//! implements [`TactileSensor`](crate::sensor::forces::reading::TactileSensor). [`TaxelChain`] does the conversion only, for drivers
//! that already have the numbers.
//!
//! Forces are computed from a row for each taxel in four steps:
//!
//! 1. The zero is subtracted from the numbers in its columns x, y, z. The zero is the mean of the first rows or given
//!    in the layout ([`ZeroConfig`]). It may follow slow drift while nothing is touched ([`TaxelDrift`]), and
//!    be measured again after a time without contact and motion ([`ZeroRule`]).
//! 2. If [`TaxelLayout::common_mode`] is set, the mean over all taxels is subtracted, which rejects uniform fields.
//! 3. The result is divided by the taxel's counts per newton, if known; otherwise forces are in counts ([`TaxelUnit`]).
//! 4. The vector is rotated to the element's frame `E_i`: x and y tangential, z compression, positive when pressed.
//!
//! Invalid values do not stop the sensor. Every row is a frame; a taxel with an invalid value has
//! [`NO_FORCE`](crate::sensor::forces::reading::NO_FORCE) in that frame. Only lines without any number are skipped. [`TableProblems`] counts
//! all problems and stores the first position of each kind.

mod built_in;
mod chain;
mod check;
mod columns;
mod common_mode;
mod error;
mod grid;
mod header;
mod layout;
mod problems;
mod rezero;
mod row;
mod rows;
mod sensor;
mod times;
mod units;
mod zero;

pub use super::table::MAX_LINE;
pub use built_in::{BUILT_IN_TAXELS, BuiltInTaxels};
pub use chain::TaxelChain;
pub use error::TaxelError;
pub use layout::{
    ColumnNames, TAXEL_LAYOUT_VERSION, Taxel, TaxelDrift, TaxelLayout, TimeColumn, ZeroConfig,
    ZeroRule,
};
pub use problems::{ProblemCount, TablePosition, TableProblem, TableProblems};
pub use rows::{TaxelRow, TaxelRows};
pub use sensor::TaxelSensor;
pub use units::{Axes, SignedAxis, TaxelUnit, TimeUnit};
