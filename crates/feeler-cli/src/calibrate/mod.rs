//! `feeler calibrate`

mod axes;
mod live;
mod wrench;

use super::{CommandError, Outcome};
use crate::options::Json;
use crate::options::Overwrite;
use axes::AxesArguments;
use feeler::sensor::calibration::{Calibration, FullScale};
use feeler::sensor::calibration_fit::{ElementRecord, ModelChoice, fit};
use feeler::sensor::calibration_quality::ElementQuality;
use feeler::sensor::calibration_report::CalibrationReport;
use feeler::sensor::live_calibration::ForceAxes;
use feeler::sensor::wrench::quality::AxisQuality;
use feeler_console::Outputs;
use feeler_console::print_json;
use feeler_console::{Steps, Working};
use feeler_lab::config::Experiment;
use feeler_lab::sensor::{LoadsFile, SensorGeometry};
use feeler_sensing::calibration::{LOADS, checks, page, write_simulated_loads};
use feeler_sensing::named_sensor;
use feeler_sim::calibration_bench::{CalibrationBenchConfig, load_simulated};
use serde::Serialize;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// The experiment whose fingertip is calibrated unless another is named.
const EXPERIMENT: &str = "cap-closing";
/// Most combined loads of a simulated calibration: more would take hours and say nothing new.
const MAX_LOADS: i64 = 20_000;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The file of loads: a table with the columns picture (a file relative to the table, or FILE@TIME, the time (s) of a frame of a
    /// video or of a recording by feeler sense), element, f_x, f_y, f_z
    /// (N, on the finger in the element's frame, f_z positive when pressed); a row of zero force, or without an element, is an unloaded picture. Columns column and
    /// row (px) tell elements by their places; x_angle (rad) is where x of the force's frame points in the picture.
    /// With --simulated, the experiment. With --wrench, the file of measured forces: picture, f_x, f_y, f_z (N) and, if
    /// they were measured, m_x, m_y, m_z (N m), on the whole fingertip.
    #[arg(value_name = "LOADS.csv", required_unless_present = "simulated")]
    input: Option<String>,
    /// Put the loads on the simulated fingertip of the experiment instead.
    #[arg(long)]
    simulated: bool,
    /// Calibrate the total force on the fingertip, where no single element can be loaded: by all elements together.
    #[arg(long, conflicts_with_all = ["simulated", "verbose", "loads", "model"])]
    wrench: bool,
    /// Keep what the pictures explain nothing of, or contradict.
    #[arg(long)]
    force_fit: bool,
    #[command(flatten)]
    axes: AxesArguments,
    /// Accept loads out of the usual range: 0.01 to 20 N on an element, with --wrench 0.05 to 200 N on the fingertip.
    #[arg(long, conflicts_with = "simulated")]
    confirm_loads: bool,
    /// The experiment whose fingertip it is: a file, or the name of a built-in one [default: cap-closing]
    #[arg(long, value_name = "EXPERIMENT")]
    experiment: Option<String>,
    #[command(flatten)]
    live: live::LiveArguments,
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
    /// Compression that shares of full scale refer to, and that --live guides up to, N [default: the largest load; simulated: 2, less
    /// with more than 41 elements; live: 1]
    #[arg(long, value_parser = positive, value_name = "N")]
    full_scale_normal: Option<f64>,
    /// Shear force that shares of full scale refer to, and that --live guides up to, N [default: the largest load; simulated and live:
    /// half of the compression]
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
    #[command(flatten)]
    json: Json,
}

/// What `--json` prints: the files, and how well held-out loads are predicted.
#[derive(Serialize)]
struct Calibrated<'a> {
    calibration: &'a Path,
    page: &'a Path,
    /// `elements`: each element by itself; `wrench`: the whole fingertip.
    of: &'static str,
    /// What shares of full scale refer to.
    full_scale: Option<FullScale>,
    /// Of each element, in the order of the layout.
    elements: Vec<&'a ElementQuality>,
    /// Of each component of the wrench.
    components: &'a [AxisQuality],
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
    arguments.live.refuse_without_effect()?;
    if arguments.wrench {
        return wrench::calibrate(arguments, out);
    }
    let output = &arguments.output;
    let page_path = page_path(output)?;
    let experiment_name = experiment_name(arguments);
    let layout = arguments.layout.as_deref();
    let sensor = named_sensor(experiment_name, arguments.finger, layout)?;
    if let Some(folder) = live::folder(arguments) {
        // Before an hour's work, not after it.
        refuse_existing(arguments, [output, &page_path])?;
        live::guide(arguments, folder, &sensor)?;
    }
    let axes = columns(arguments);
    let loads = loads_file(arguments, &sensor, axes)?;
    let files = loads.as_ref().map_or_else(Vec::new, LoadsFile::files);
    let inputs = files.iter().map(|path| Some(path.as_path()));
    let named = [Some(Path::new(experiment_name)), layout];
    let mut outputs = Outputs::new(arguments.overwrite.force, inputs.chain(named));
    // Opened first, for calibrating takes its time.
    let file = outputs.create(output, "--output")?;
    let page_file = outputs.create(&page_path, "--output")?;
    let measured = loads.as_ref().map(|loads| {
        let progress = Steps::new(loads.picture_count());
        let measured = loads.measure(&sensor, || progress.advance())?;
        drop(progress);
        if !arguments.force_fit {
            checks::before_fitting(loads, &measured, axes)?;
        }
        Ok::<_, CommandError>((loads, measured))
    });
    let measured = measured.transpose()?;
    let (records, source, full_scale) = match &measured {
        Some((loads, measured)) => {
            let records = measured.records();
            let full_scale = FullScale::of_loads(&records);
            (records, loads.name(), full_scale)
        }
        None => simulated(arguments)?,
    };
    let full_scale = FullScale {
        normal: arguments.full_scale_normal.unwrap_or(full_scale.normal),
        shear: arguments.full_scale_shear.unwrap_or(full_scale.shear),
    };
    let fitting = Working::on("fitting");
    let mut calibration = fit(sensor.made_for, &records, arguments.model, full_scale)?;
    calibration.loads_confirmed = arguments.confirm_loads;
    calibration.check_magnitude()?;
    drop(fitting);
    if !arguments.force_fit {
        checks::noise(&calibration, &records)?;
        if let Some((loads, measured)) = &measured {
            checks::after_fitting(loads, measured, &calibration)?;
        }
    }
    page_file.finish(page(&calibration, &records, &source).as_bytes())?;
    file.finish(calibration.to_toml()?.as_bytes())?;
    if arguments.json.json {
        let elements = calibration.elements.iter();
        let calibrated = Calibrated {
            calibration: output,
            page: &page_path,
            of: "elements",
            full_scale: Some(calibration.full_scale),
            elements: elements.map(|element| &element.quality).collect(),
            components: &[],
        };
        print_json(&calibrated, out)?;
        return Ok(Outcome::Done);
    }
    print(arguments, &calibration, out)?;
    writeln!(out, "{}\n{}", output.display(), page_path.display())?;
    Ok(Outcome::Done)
}

/// The columns of the loads that are x, y and z of an element.
fn columns(arguments: &Arguments) -> ForceAxes {
    match live::folder(arguments) {
        // Those of the force sensor are turned already.
        Some(_) => ForceAxes::default(),
        None => arguments.axes.of_columns(),
    }
}

/// The loads on disk; `None` if they are simulated.
fn loads_file(
    arguments: &Arguments,
    sensor: &SensorGeometry,
    axes: ForceAxes,
) -> Result<Option<LoadsFile>, CommandError> {
    let Some(input) = arguments.input.as_ref().filter(|_| !arguments.simulated) else {
        return Ok(None);
    };
    let csv = match live::folder(arguments) {
        Some(folder) => folder.join(LOADS),
        None => PathBuf::from(input),
    };
    let loads = LoadsFile::read(&csv, &sensor.seen, axes)?;
    if !arguments.confirm_loads {
        checks::magnitude(&loads)?;
    }
    Ok(Some(loads))
}

/// Refuses outputs that would be refused when they are made.
fn refuse_existing(arguments: &Arguments, outputs: [&Path; 2]) -> Result<(), CommandError> {
    let mut made = Outputs::new(arguments.overwrite.force, []);
    for path in outputs {
        made.create(path, "--output")?.discard();
    }
    Ok(())
}

/// The page beside `output`.
fn page_path(output: &Path) -> Result<PathBuf, CommandError> {
    let page_path = output.with_extension("html");
    if page_path == *output {
        return Err(format!(
            "--output {}: the page beside it would have the same name; expected a name that ends in .toml",
            output.display()
        )
        .into());
    }
    Ok(page_path)
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

/// What is known of each element of a simulated fingertip, where it comes from, and what shares of full scale refer to.
fn simulated(
    arguments: &Arguments,
) -> Result<(Vec<ElementRecord>, String, FullScale), CommandError> {
    let experiment = Experiment::load(experiment_name(arguments), &[])?;
    let fingertip = experiment.fingertip(arguments.finger)?;
    let config = &experiment.config;
    let optics = &config.simulation()?.optics;
    let bench = CalibrationBenchConfig {
        seed: arguments.seed,
        ..CalibrationBenchConfig::of_fingertip(fingertip, optics, arguments.loads as usize)
    };
    let _working = Working::on("loading the simulated fingertip");
    if let Some(folder) = &arguments.write_loads {
        write_simulated_loads(folder, fingertip, optics, &bench)?;
    }
    let records = load_simulated(fingertip, optics, &bench)?;
    let source = format!("{}, simulated", config.name);
    Ok((records, source, bench.full_scale))
}
