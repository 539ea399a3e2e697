//! The `feeler init` subcommand.

use crate::{CommandError, Outcome};
use feeler_console::Outputs;
use feeler_lab::config::key::did_you_mean;
use feeler_lab::config::{BUILT_IN, Experiment};
use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Experiment file to create, e.g. my.toml. Must not exist.
    #[arg(value_name = "FILE.toml")]
    file: PathBuf,
    /// Built-in experiment to start from (see `feeler list`).
    #[arg(long, value_name = "NAME", default_value = "cap-closing")]
    from: String,
    /// Write every key of the built-in experiment, not only the commonly set ones.
    #[arg(long)]
    full: bool,
}

/// Comment at the top of a file that contains only the commonly set keys.
const HEADING: &str = "\
# Commonly set keys; `feeler init all.toml --full` writes every key. Omitted keys have their defaults
# (docs/experiment-files.md). Units are SI unless a suffix states otherwise. W is the world frame: z up.

";

pub fn init(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let (file, from) = (&arguments.file, &arguments.from);
    if !BUILT_IN.iter().any(|built_in| built_in.name == from) {
        let names = BUILT_IN.map(|built_in| built_in.name).join(", ");
        let like = did_you_mean(from, BUILT_IN.iter().map(|built_in| built_in.name));
        return Err(format!("--from {from}: expected one of the built-in {names}{like}").into());
    }
    let experiment = Experiment::load(from, &[format!("name={:?}", name(file)?)])?;
    let mut outputs = Outputs::without_force("a new file");
    let toml = outputs.create(file, "FILE.toml")?;
    let calibrations = missing(file, &experiment.calibration_texts()?)?;
    for (path, text) in &calibrations {
        outputs
            .create(path, "calibration")?
            .finish(text.as_bytes())?;
    }
    let text = match arguments.full {
        true => experiment.toml,
        false => experiment.in_short(HEADING),
    };
    toml.finish(text.as_bytes())?;
    for path in calibrations.iter().map(|(path, _)| path).chain([file]) {
        writeln!(out, "{}", path.display())?;
    }
    writeln!(
        out,
        "run the experiment with `feeler run {}`",
        file.display()
    )?;
    Ok(Outcome::Done)
}

/// Returns the name of the experiment: the file name without its extension.
fn name(file: &Path) -> Result<&str, CommandError> {
    let is_toml = file
        .extension()
        .is_some_and(|extension| extension == "toml");
    let stem = file.file_stem().and_then(|stem| stem.to_str());
    stem.filter(|_| is_toml).ok_or_else(|| {
        let file = file.display();
        format!("{file}: expected a file whose name ends in .toml").into()
    })
}

/// Returns the calibration files that do not yet exist next to `file`. An existing file must have the same content.
pub(crate) fn missing(
    file: &Path,
    texts: &BTreeMap<String, String>,
) -> Result<Vec<(PathBuf, String)>, CommandError> {
    let folder = file.parent().unwrap_or(Path::new(""));
    let mut missing = Vec::new();
    for (name, text) in texts {
        let path = folder.join(name);
        match fs::read_to_string(&path) {
            Ok(there) if there == *text => {}
            Ok(_) => {
                let path = path.display();
                let message = "exists already with another calibration; expected another folder";
                return Err(format!("{path}: {message}").into());
            }
            Err(_) => missing.push((path, text.clone())),
        }
    }
    Ok(missing)
}
