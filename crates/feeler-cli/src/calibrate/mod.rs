//! `feeler calibrate`

mod loads;
mod page;

use super::part_file::{Outputs, Overwrite};
use super::progress::{Steps, Working};
use super::sense::sensor::named_sensor;
use super::{CommandError, Outcome};
use feeler::sensor::calibration::{Calibration, FullScale};
use feeler::sensor::calibration_fit::{ElementRecord, ModelChoice, fit};
use feeler::sensor::calibration_report::CalibrationReport;
use feeler_lab::config::Experiment;
use feeler_lab::sensor::LoadsFile;
use feeler_sim::calibration_bench::{CalibrationBenchConfig, load_simulated};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// The experiment whose fingertip is calibrated unless another is named.
const EXPERIMENT: &str = "cap-closing";
/// Most combined loads of a simulated calibration: more would take hours and say nothing new.
const MAX_LOADS: i64 = 20_000;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The file of loads: CSV with the columns picture (relative to the file), element, f_x, f_y, f_z
    /// (N, in the element's frame); a row of zero force, or without an element, is an unloaded picture.
    /// With --simulated, the experiment.
    #[arg(value_name = "LOADS.csv", required_unless_present = "simulated")]
    input: Option<String>,
    /// Put the loads on the simulated fingertip of the experiment instead.
    #[arg(long)]
    simulated: bool,
    /// The experiment whose fingertip it is: a file, or the name of a built-in one [default: cap-closing]
    #[arg(long, value_name = "EXPERIMENT")]
    experiment: Option<String>,
    /// The finger of the experiment whose fingertip it is, from 0 [default: what fingers have without
    /// one of their own]
    #[arg(long, value_name = "NUMBER", conflicts_with = "layout")]
    finger: Option<usize>,
    /// The sensing elements as `feeler locate` found them, instead of an experiment's.
    #[arg(long, value_name = "LAYOUT.toml", conflicts_with_all = ["simulated", "experiment"])]
    layout: Option<PathBuf>,
    /// Output file; a page with curves and residuals is written beside it.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    overwrite: Overwrite,
    /// Model to fit: the paper's (separable), one that includes the tilt of the column (coupled), or whichever
    /// predicts held-out loads better (auto).
    #[arg(long, value_parser = model, default_value = "auto", value_name = "MODEL")]
    model: ModelChoice,
    /// Compression that shares of full scale refer to, N [default: the largest load; simulated: 2]
    #[arg(long, value_parser = positive, value_name = "N")]
    full_scale_normal: Option<f64>,
    /// Shear force that shares of full scale refer to, N [default: the largest load; simulated: 1]
    #[arg(long, value_parser = positive, value_name = "N")]
    full_scale_shear: Option<f64>,
    /// Print the errors of each element, not only of each ring.
    #[arg(long)]
    verbose: bool,
    /// Seed of the simulated loads' order and of the simulated camera's noise.
    #[arg(long, default_value_t = CalibrationBenchConfig::default().seed, value_parser = crate::trials::parse_seed)]
    seed: u64,
    /// Combined loads that are put on the simulated fingertip, at most 20,000 (some 35,000 pictures, which take
    /// minutes); other kinds in proportion.
    #[arg(long, default_value_t = CalibrationBenchConfig::default().combined as u32, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1..=MAX_LOADS))]
    loads: u32,
    /// Write the simulated pictures and their LOADS.csv into this folder, which must not hold any yet.
    #[arg(long, value_name = "DIR", requires = "simulated")]
    write_loads: Option<PathBuf>,
}

/// The model of this name.
fn model(name: &str) -> Result<ModelChoice, String> {
    match name {
        "separable" => Ok(ModelChoice::Separable),
        "coupled" => Ok(ModelChoice::Coupled),
        "auto" => Ok(ModelChoice::Auto),
        _ => Err("expected separable, coupled or auto".into()),
    }
}

fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok();
    let positive = number.filter(|number| number.is_finite() && *number > 0.0);
    positive.ok_or_else(|| "expected a force above 0 N".into())
}

pub fn calibrate(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let output = &arguments.output;
    let page_path = output.with_extension("html");
    if page_path == *output {
        return Err(format!(
            "--output {}: the page beside it would have the same name; expected a name that ends in .toml",
            output.display()
        )
        .into());
    }
    let experiment_name = experiment_name(arguments);
    let layout = arguments.layout.as_deref();
    let sensor = named_sensor(experiment_name, arguments.finger, layout)?;
    let csv = arguments.input.as_ref().filter(|_| !arguments.simulated);
    let elements = sensor.kernel.element_count();
    let loads = csv.map(|csv| LoadsFile::read(Path::new(csv), elements));
    let loads = loads.transpose()?;
    let files = loads.as_ref().map_or_else(Vec::new, LoadsFile::files);
    let inputs = files.iter().map(|path| Some(path.as_path()));
    let named = [Some(Path::new(experiment_name)), layout];
    let mut outputs = Outputs::new(arguments.overwrite, inputs.chain(named));
    // Opened first, for calibrating takes its time.
    let file = outputs.create(output, "--output")?;
    let page_file = outputs.create(&page_path, "--output")?;
    let (records, source) = match &loads {
        Some(loads) => {
            let progress = Steps::new(loads.picture_count());
            (loads.measure(&sensor, || progress.advance())?, loads.name())
        }
        None => simulated(arguments)?,
    };
    let full_scale = full_scale(arguments, &records);
    let fitting = Working::on("fitting");
    let calibration = fit(sensor.made_for, &records, arguments.model, full_scale)?;
    drop(fitting);
    page_file.finish(page::page(&calibration, &records, &source).as_bytes())?;
    file.finish(calibration.to_toml()?.as_bytes())?;
    print(arguments, &calibration, out)?;
    writeln!(out, "{}\n{}", output.display(), page_path.display())?;
    Ok(Outcome::Done)
}

fn print(arguments: &Arguments, calibration: &Calibration, out: &mut dyn Write) -> io::Result<()> {
    let report = CalibrationReport {
        calibration,
        verbose: arguments.verbose,
    };
    writeln!(out, "{report}")
}

/// The experiment whose fingertip it is.
fn experiment_name(arguments: &Arguments) -> &str {
    let input = arguments.input.as_deref().filter(|_| arguments.simulated);
    let name = arguments.experiment.as_deref().or(input);
    name.unwrap_or(EXPERIMENT)
}

/// What is known of each element of a simulated fingertip, and where it comes from.
fn simulated(arguments: &Arguments) -> Result<(Vec<ElementRecord>, String), CommandError> {
    let experiment = Experiment::load(experiment_name(arguments), &[])?;
    let fingertip = experiment.fingertip(arguments.finger)?;
    let config = &experiment.config;
    let optics = &config.simulation()?.optics;
    let bench = CalibrationBenchConfig {
        seed: arguments.seed,
        ..CalibrationBenchConfig::of_size(arguments.loads as usize)
    };
    let _working = Working::on("loading the simulated fingertip");
    if let Some(folder) = &arguments.write_loads {
        loads::write_simulated(folder, fingertip, optics, &bench)?;
    }
    let records = load_simulated(fingertip, optics, &bench)?;
    Ok((records, format!("{}, simulated", config.name)))
}

/// What shares of full scale refer to: as asked for, or as large as the loads.
fn full_scale(arguments: &Arguments, records: &[ElementRecord]) -> FullScale {
    let default = match arguments.simulated {
        true => FullScale::default(),
        false => FullScale::of_loads(records),
    };
    FullScale {
        normal: arguments.full_scale_normal.unwrap_or(default.normal),
        shear: arguments.full_scale_shear.unwrap_or(default.shear),
    }
}
