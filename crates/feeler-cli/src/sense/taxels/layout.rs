//! Selection of the taxel layout.

use super::super::{Arguments, CommandError};
use feeler::sensor::taxel::{BUILT_IN_TAXELS, BuiltInTaxels, TaxelLayout};
use std::fs;
use std::path::Path;

/// Options for taxel arrays.
#[derive(Debug, clap::Args)]
pub struct TaxelArguments {
    /// Read a table of a three-axis taxel array with this layout: a file or a built-in one (see `feeler list`).
    #[arg(long, value_name = "LAYOUT", conflicts_with_all = [
        "layout", "calibration", "drift_correction", "reference", "raw", "size", "exposure"])]
    pub(in super::super) taxels: Option<String>,
    /// Prefix of the array's columns if the table has several arrays, as in left.
    #[arg(long, value_name = "PREFIX", requires = "taxels")]
    prefix: Option<String>,
    /// Column whose value changes where a new sequence begins, which starts without load.
    #[arg(long, value_name = "COLUMN", requires = "taxels")]
    sequence: Option<String>,
}

/// Reads the layout `name` (a file or a built-in one) and applies the options in `arguments`.
pub fn read(arguments: &Arguments, name: &str) -> Result<TaxelLayout, CommandError> {
    let text = text_of(name)?;
    let refused = |e| format!("--taxels {name}: {e}");
    let mut layout = TaxelLayout::from_toml(&text).map_err(refused)?;
    let TaxelArguments {
        prefix, sequence, ..
    } = &arguments.taxels;
    if let Some(prefix) = prefix {
        layout.columns.prefix.clone_from(prefix);
    }
    if sequence.is_some() {
        layout.columns.sequence.clone_from(sequence);
    }
    if let Some(rows) = arguments.unloaded {
        layout.zero.rows = rows;
        for taxel in &mut layout.taxels {
            taxel.zero = None;
        }
    }
    layout.check().map_err(refused)?;
    Ok(layout)
}

/// Returns the text of the layout `name`, a file or a built-in one.
pub fn text_of(name: &str) -> Result<String, CommandError> {
    match BuiltInTaxels::named(name) {
        Some(built_in) => Ok(built_in.text.to_owned()),
        None => read_file(name),
    }
}

fn read_file(name: &str) -> Result<String, CommandError> {
    let names: Vec<_> = BUILT_IN_TAXELS.iter().map(|b| b.name).collect();
    fs::read_to_string(Path::new(name)).map_err(|error| {
        let names = names.join(", ");
        format!("--taxels {name}: {error}; expected a file, or one of {names}").into()
    })
}
