//! Three-axis taxel arrays that others make, as tactile sensors: uSkin, AnySkin, ReSkin, eFlesh, PapillArray.
//!
//! Their readings come as a table, a row for each sample: a file, or rows on a stream as they are taken. A
//! [`TaxelLayout`] (TOML) says which columns belong to which taxel, where taxels sit, how their axes stand, and in what
//! unit they measure. [`TaxelSensor`] reads the rows and is a [`TactileSensor`](super::reading::TactileSensor) like any
//! other. [`TaxelChain`] is the part behind the table, for drivers that have the numbers already.
//!
//! From a row to forces, for each taxel:
//!
//! 1. the numbers in its columns x, y, z, less what they are without load ([`ZeroConfig`]: the mean of the first rows, or
//!    what the layout says), which may slowly be followed while nothing is touched ([`TaxelDrift`]);
//! 2. divided by its counts per newton, where they are known; else forces are *in counts*, for which [`TaxelUnit`] stands;
//! 3. turned into the element's frame `E_i`: x and y along the tangent plane, z compression, positive when pressed.
//!
//! Real tables are messy. A row is a frame whatever stands in it: a value that is none becomes
//! [`NO_FORCE`](super::reading::NO_FORCE), in that frame and for that taxel. Only lines without a single number are
//! passed over. [`Troubles`] counts all of it and keeps where each kind of trouble stood first.

mod built_in;
mod chain;
mod check;
mod columns;
mod error;
mod header;
mod layout;
mod row;
mod rows;
mod sensor;
mod times;
mod troubles;
mod units;
mod zero;

pub use super::table::MAX_LINE;
pub use built_in::{BUILT_IN_TAXELS, BuiltInTaxels};
pub use chain::TaxelChain;
pub use error::TaxelError;
pub use layout::{
    ColumnNames, TAXEL_LAYOUT_VERSION, Taxel, TaxelDrift, TaxelLayout, TimeColumn, ZeroConfig,
};
pub use rows::{TaxelRow, TaxelRows};
pub use sensor::TaxelSensor;
pub use troubles::{Place, Seen, Trouble, Troubles};
pub use units::{Axes, SignedAxis, TaxelUnit, TimeUnit};
