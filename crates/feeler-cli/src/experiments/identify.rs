//! The `feeler identify` subcommand.

use crate::options::{Overwrite, SettingArguments};
use crate::{CommandError, Outcome};
use feeler_console::Outputs;
use feeler_lab::config::Experiment;
use feeler_lab::identify::{estimate, page, probe, probing};
use feeler_report::pages::{IdentifyPage, identify_page};
use feeler_report::run::create_folder;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// File names in the output folder.
const ESTIMATES: &str = "identified.toml";
const PAGE: &str = "identify.html";

const EXAMPLES: &str = "\
The fingers touch, press, shear and slide at three places, along the rectangles of [task.screw] or as specified by [task.probe]. This takes
less than half a minute of simulated time. identified.toml contains each estimate with its 95 % interval; identify.html also shows the
probes and fits.

Examples:
  feeler identify cap-closing
  feeler identify my.toml --sensing direct --seed 7 --out runs/identified
  feeler identify my.toml --set sim.feeler.normal_stiffness=400 --force";

#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// Experiment file or name of a built-in experiment, with [task.screw] or [task.probe].
    experiment: String,
    #[command(flatten)]
    changes: SettingArguments,
    /// Output folder [default: runs/NAME-identified]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    overwrite: Overwrite,
}

pub fn identify(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let settings = arguments.changes.settings();
    let experiment = probing(&Experiment::load(&arguments.experiment, &settings)?)?;
    let config = &experiment.config;
    let default = || Path::new("runs").join(format!("{}-identified", config.name));
    let folder = arguments.out.clone().unwrap_or_else(default);
    check_new(&folder, arguments.overwrite)?;

    let (identified, fits) = estimate(&probe(&experiment)?, &config.name, config.seed)?;
    let page = page(&identified, &fits);
    let files = [
        (ESTIMATES, identified.to_toml()?),
        (PAGE, identify_page(&page)),
    ];
    create_folder(&folder).map_err(|e| format!("--out {}: {e}", folder.display()))?;
    let input = Some(Path::new(&arguments.experiment));
    let mut outputs = Outputs::new(arguments.overwrite.force, [input]);
    for (name, text) in files {
        let file = outputs.create(&folder.join(name), "--out")?;
        file.finish(text.as_bytes())?;
    }
    print(&page, out)?;
    for name in [ESTIMATES, PAGE] {
        writeln!(out, "{}", folder.join(name).display())?;
    }
    Ok(Outcome::Done)
}

/// Rejects a folder that already contains estimates, before the hand moves.
fn check_new(folder: &Path, overwrite: Overwrite) -> Result<(), CommandError> {
    let taken = [ESTIMATES, PAGE].map(|name| folder.join(name));
    let found = taken.iter().find(|path| path.exists());
    match found.filter(|_| !overwrite.force) {
        Some(found) => Err(format!(
            "--out {}: exists already; expected a new folder, or --force to replace it",
            found.display()
        )
        .into()),
        None => Ok(()),
    }
}

fn print(page: &IdentifyPage, out: &mut dyn Write) -> io::Result<()> {
    for row in &page.rows {
        let name = format!("{}, {}", row.quantity, row.of);
        let [value, low, high] = row.value;
        let unit = row.unit;
        writeln!(
            out,
            "{name:26} {value:9.3}   {low:9.3} to {high:9.3} {unit}"
        )?;
    }
    for warning in &page.warnings {
        writeln!(out, "warning: {warning}")?;
    }
    Ok(())
}
