//! Selection of the taxel layout.

use crate::calibration::require_verified;
use feeler::sensor::taxel::{BUILT_IN_TAXELS, BuiltInTaxels, TaxelLayout};
use feeler::sensor::wrench::taxels::{TaxelCalibration, TaxelWrenchEstimator};
use feeler_console::CommandError;
use std::fmt::Display;
use std::fs;
use std::path::Path;

/// Layout of a taxel array and the columns of its table.
#[derive(Debug, Clone, Default)]
pub struct TaxelOptions {
    /// Layout: a file or a built-in name; `None` if the source is not a taxel array.
    pub taxels: Option<String>,
    /// Column prefix of the array, if a table contains several arrays.
    pub prefix: Option<String>,
    /// Column whose value changes where the next sequence begins.
    pub sequence: Option<String>,
}

/// Reads the layout `name` (a file or a built-in one) and applies `options` and the number of `unloaded` rows.
///
/// # Errors
/// If there is no such layout, or a value is invalid.
pub fn read_taxel_layout(
    name: &str,
    options: &TaxelOptions,
    unloaded: Option<u32>,
) -> Result<TaxelLayout, CommandError> {
    let text = taxel_layout_text(name)?;
    let refused = |e| format!("--taxels {name}: {e}");
    let mut layout = TaxelLayout::from_toml(&text).map_err(refused)?;
    let TaxelOptions {
        prefix, sequence, ..
    } = options;
    if let Some(prefix) = prefix {
        layout.columns.prefix.clone_from(prefix);
    }
    if sequence.is_some() {
        layout.columns.sequence.clone_from(sequence);
    }
    if let Some(rows) = unloaded {
        layout.zero.rows = rows;
        for taxel in &mut layout.taxels {
            taxel.zero = None;
        }
    }
    layout.check().map_err(refused)?;
    Ok(layout)
}

/// Returns the text of the layout called `name`: a file or a built-in one.
///
/// # Errors
/// If there is neither.
pub fn taxel_layout_text(name: &str) -> Result<String, CommandError> {
    match BuiltInTaxels::named(name) {
        Some(built_in) => Ok(built_in.text.to_owned()),
        None => read_file(name),
    }
}

/// Creates the estimator of the wrench calibration at `path`, which must match `layout` and, if a number of days is
/// given, have been verified within it.
pub fn read_estimator(
    path: &Path,
    layout: &TaxelLayout,
    verified_within: Option<u32>,
) -> Result<TaxelWrenchEstimator, CommandError> {
    let named = |e: &dyn Display| format!("--calibration {}: {e}", path.display());
    let text = fs::read_to_string(path).map_err(|e| named(&e))?;
    let calibration = TaxelCalibration::from_toml(&text).map_err(|e| named(&e))?;
    let target = layout.calibration_target()?;
    calibration.verify_target(&target).map_err(|e| named(&e))?;
    if let Some(days) = verified_within {
        require_verified(&calibration, days)
            .map_err(|e| named(&format!("--verified-within {days}: {e}")))?;
    }
    Ok(TaxelWrenchEstimator::new(calibration).map_err(|e| named(&e))?)
}

fn read_file(name: &str) -> Result<String, CommandError> {
    let names: Vec<_> = BUILT_IN_TAXELS.iter().map(|b| b.name).collect();
    fs::read_to_string(Path::new(name)).map_err(|error| {
        let names = names.join(", ");
        format!("--taxels {name}: {error}; expected a file, or one of {names}").into()
    })
}
