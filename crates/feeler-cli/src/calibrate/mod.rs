//! The `feeler calibrate` subcommand.

pub mod axes;
pub mod live;
mod wrench;

use super::{CommandError, Outcome};
use crate::options::{Json, Overwrite};
use axes::AxesArguments;
use feeler::sensor::calibration::{
    Calibration, CalibrationReport, ElementQuality, ElementRecord, ForceAxes, FullScale,
    ModelChoice, fit,
};
use feeler::sensor::wrench::quality::AxisQuality;
use feeler_console::{Outputs, PartFile, Steps, Working, print_json};
use feeler_lab::config::Experiment;
use feeler_lab::sensor::{LoadsFile, SensorGeometry};
use feeler_sensing::calibration::{LOADS, checks, page, write_simulated_loads};
use feeler_sensing::named_sensor;
use feeler_sim::bench::{CalibrationBenchConfig, load_simulated};
use serde::Serialize;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Experiment whose fingertip is calibrated by default.
const EXPERIMENT: &str = "cap-closing";
/// Maximum number of combined loads of a simulated calibration; more would take hours without improving the result.
const MAX_LOADS: i64 = 20_000;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Table of loads and images; with --wrench, of total forces; with --simulated, the experiment.
    ///
    /// Columns: picture (a file relative to the table, or FILE@TIME for the frame at TIME (s) of a video or of a
    /// recording by `feeler sense`), element, f_x, f_y, f_z (N, on the finger in the element's frame; f_z is positive
    /// when pressed). A row of zero force, or without an element, is an image without load. The columns column and
    /// row (px) identify elements by position instead; x_angle (rad) is the direction of the force frame's x axis in
    /// the image.
    ///
    /// With --wrench, a table of forces on the whole fingertip: picture, or recording and time (s); and one or more of
    /// f_x, f_y, f_z (N, or with a unit as in "f_z [gf]"), m_x, m_y, m_z (N m), p_x, p_y (place of contact, m). With
    /// --taxels, recording is a table of taxels, relative to this one, and time is on the clock of its time column.
    #[arg(value_name = "LOADS.csv", required_unless_present = "simulated")]
    input: Option<String>,
    /// Apply loads to the simulated fingertip of the experiment instead.
    #[arg(long)]
    simulated: bool,
    /// Calibrate the total force on the fingertip from all elements together, if elements cannot be loaded individually.
    #[arg(long, conflicts_with_all = ["simulated", "verbose", "loads", "model"])]
    wrench: bool,
    /// Accept a calibration that predicts no better than the mean, or loads that contradict the images.
    #[arg(long)]
    force_fit: bool,
    #[command(flatten)]
    axes: AxesArguments,
    /// Accept loads outside the usual range: 0.01 to 20 N on an element, or with --wrench 0.05 to 200 N on the
    /// fingertip.
    #[arg(long, conflicts_with = "simulated")]
    confirm_loads: bool,
    /// Experiment that defines the fingertip: a file, or the name of a built-in one [default: cap-closing]
    #[arg(long, value_name = "EXPERIMENT")]
    experiment: Option<String>,
    #[command(flatten)]
    live: live::LiveArguments,
    /// Index of the finger whose fingertip is calibrated [default: the fingertip shared by all fingers]
    #[arg(long, value_name = "NUMBER", conflicts_with = "layout")]
    finger: Option<usize>,
    /// Layout file of the sensing elements, written by `feeler locate`, instead of an experiment.
    #[arg(long, value_name = "LAYOUT.toml", conflicts_with_all = ["simulated", "experiment"])]
    layout: Option<PathBuf>,
    /// Track each marker of the layout, even beyond its neighbours' places.
    ///
    /// Requires --wrench, --layout and images; `feeler sense` with the calibration tracks markers, too.
    #[arg(long, requires_all = ["wrench", "layout"], conflicts_with = "taxels")]
    track: bool,
    /// Calibrate a taxel array with this layout: a file or a built-in one (see `feeler list`). Requires --wrench.
    #[arg(long, value_name = "LAYOUT", requires = "wrench", conflicts_with_all = ["layout", "experiment", "finger", "live"])]
    taxels: Option<String>,
    /// Prefix of the array's columns if tables have several arrays, for example left.
    #[arg(long, value_name = "PREFIX", requires = "taxels")]
    prefix: Option<String>,
    /// Transfer this wrench calibration of another copy of the sensor, with a few presses in FORCES.csv (ten are enough).
    #[arg(long, value_name = "WRENCH.toml", requires = "wrench")]
    from: Option<PathBuf>,
    /// Conditions to record in the calibration, for example "22 °C, new gel".
    #[arg(long, value_name = "TEXT", requires = "wrench", default_value = "")]
    conditions: String,
    /// Calibration file to write; a report with curves and residuals is written next to it.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    overwrite: Overwrite,
    /// Model to fit: separable, coupled or auto.
    ///
    /// `separable` is the paper's model, `coupled` also models the tilt of the column, and `auto` chooses the one
    /// that predicts held-out loads better.
    #[arg(long, value_parser = model, default_value = "auto", value_name = "MODEL")]
    model: ModelChoice,
    /// Full-scale compression (N), and target of --live [default: the largest load; simulated: 2, less with more than
    /// 41 elements; live: 1]
    #[arg(long, value_parser = positive, value_name = "N")]
    full_scale_normal: Option<f64>,
    /// Full-scale shear (N), and target of --live [default: the largest load; simulated and live: half of the
    /// compression]
    #[arg(long, value_parser = positive, value_name = "N")]
    full_scale_shear: Option<f64>,
    /// Print the errors of each element, not only of each ring.
    #[arg(long)]
    verbose: bool,
    /// Random seed of the order of simulated loads and of the simulated camera's noise.
    #[arg(long, default_value_t = CalibrationBenchConfig::default().seed, value_parser = crate::experiments::trials::parse_seed)]
    seed: u64,
    /// Number of combined loads on the simulated fingertip, at most 20,000; other kinds of load scale with it.
    ///
    /// 20,000 combined loads are some 35,000 images, which take minutes.
    #[arg(long, default_value_t = CalibrationBenchConfig::default().combined as u32, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1..=MAX_LOADS))]
    loads: u32,
    /// Write the simulated images and their LOADS.csv into this folder, which must not contain any yet.
    #[arg(long, value_name = "DIR", requires = "simulated")]
    write_loads: Option<PathBuf>,
    #[command(flatten)]
    json: Json,
}

/// Output of `--json`: the files written, and the errors of held-out loads.
#[derive(Serialize)]
struct Calibrated<'a> {
    calibration: &'a Path,
    page: &'a Path,
    /// `elements` if each element was calibrated separately, `wrench` for the whole fingertip.
    of: &'static str,
    /// Forces that percentages of full scale refer to.
    full_scale: Option<FullScale>,
    /// Quality of each element, in the order of the layout.
    elements: Vec<&'a ElementQuality>,
    /// Quality of each component of the wrench.
    components: &'a [AxisQuality],
}

/// Parses the name of a model.
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
    let live = &arguments.live;
    live.rig.check_options(live.live.as_deref())?;
    if arguments.wrench {
        return wrench::calibrate(arguments, out);
    }
    let output = &arguments.output;
    let page_path = page_path(output)?;
    let sensor = sensor(arguments)?;
    guide_live(arguments, &sensor, &page_path)?;
    let axes = columns(arguments);
    let loads = loads_file(arguments, &sensor, axes)?;
    let files = loads.as_ref().map_or_else(Vec::new, LoadsFile::files);
    // Opened first, because calibrating takes a while.
    let [file, page_file] = create_outputs(arguments, &files, &page_path)?;
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

/// Returns the columns that are x, y and z of an element's force.
fn columns(arguments: &Arguments) -> ForceAxes {
    match live::folder(arguments) {
        // Live forces are converted when they are recorded.
        Some(_) => ForceAxes::default(),
        None => arguments.axes.of_columns(),
    }
}

/// Reads the loads from disk, or returns `None` if they are simulated.
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

/// Returns the geometry of the sensor.
fn sensor(arguments: &Arguments) -> Result<SensorGeometry, CommandError> {
    let layout = arguments.layout.as_deref();
    let sensor = named_sensor(experiment_name(arguments), arguments.finger, layout)?;
    Ok(SensorGeometry {
        tracked: arguments.track,
        ..sensor
    })
}

/// Guides through live loading if requested. Returns the folder of the loads.
fn guide_live<'a>(
    arguments: &'a Arguments,
    sensor: &SensorGeometry,
    page_path: &Path,
) -> Result<Option<&'a Path>, CommandError> {
    let folder = live::folder(arguments);
    if let Some(folder) = folder {
        // Fail before an hour of work rather than after it.
        let mut outputs = Outputs::new(arguments.overwrite.force, []);
        for path in [arguments.output.as_path(), page_path] {
            outputs.create(path, "--output")?.discard();
        }
        live::guide(arguments, folder, sensor)?;
    }
    Ok(folder)
}

/// Creates the calibration file and its page. `files` are the inputs, besides those named by options.
fn create_outputs(
    arguments: &Arguments,
    files: &[PathBuf],
    page_path: &Path,
) -> Result<[PartFile; 2], CommandError> {
    let inputs = files.iter().map(|path| Some(path.as_path()));
    let experiment = Path::new(experiment_name(arguments));
    let taxels = arguments.taxels.as_deref().map(Path::new);
    let named = [Some(experiment), arguments.layout.as_deref(), taxels];
    let mut outputs = Outputs::new(arguments.overwrite.force, inputs.chain(named));
    Ok([
        outputs.create(&arguments.output, "--output")?,
        outputs.create(page_path, "--output")?,
    ])
}

/// Returns the path of the report next to `output`.
fn page_path(output: &Path) -> Result<PathBuf, CommandError> {
    let page_path = output.with_extension("html");
    if page_path == *output {
        return Err(format!(
            "--output {}: expected a name that ends in .toml, because the report next to it ends in .html",
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

/// Returns the experiment that defines the fingertip.
fn experiment_name(arguments: &Arguments) -> &str {
    let input = arguments.input.as_deref().filter(|_| arguments.simulated);
    let name = arguments.experiment.as_deref().or(input);
    name.unwrap_or(EXPERIMENT)
}

/// Simulates the loads; returns the samples of each element, a description of their source, and full scale.
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
