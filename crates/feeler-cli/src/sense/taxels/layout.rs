//! Which taxel array is meant.

use super::super::{Arguments, CommandError};
use feeler::sensor::taxel::{BUILT_IN_TAXELS, BuiltInTaxels, TaxelLayout};
use std::fs;
use std::path::Path;

/// What is said of a taxel array.
#[derive(Debug, clap::Args)]
pub struct TaxelArguments {
    /// The source is the table of a three-axis taxel array, of this layout: a file, or a built-in one (`feeler list`).
    #[arg(long, value_name = "LAYOUT", conflicts_with_all = [
        "layout", "calibration", "drift_correction", "reference", "raw", "size", "exposure"])]
    pub(in super::super) taxels: Option<String>,
    /// What the columns of the array begin with, where a table has several arrays, as in left.
    #[arg(long, value_name = "PREFIX", requires = "taxels")]
    prefix: Option<String>,
    /// Column whose value changes where another sequence begins, without load again.
    #[arg(long, value_name = "COLUMN", requires = "taxels")]
    sequence: Option<String>,
}

/// The layout called `name` (a file, or a built-in one), with what the arguments say of it.
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

/// The text of the layout called `name`, a file or a built-in one.
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
