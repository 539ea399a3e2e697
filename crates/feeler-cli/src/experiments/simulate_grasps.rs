//! The `feeler simulate-grasps` subcommand: simulated grasps with labels, as recordings for `feeler score-slip`.

use super::trials::{in_parallel, jobs, trial_seed};
use crate::options::Overwrite;
use crate::{CommandError, Outcome};
use feeler::sensor::fingertip::{ElementPlace, LAYOUT_VERSION, LocatedLayout};
use feeler::sensor::image::Polarity;
use feeler_console::{Outputs, PartFile, Steps, watch_for_interrupt};
use feeler_lab::grasps::simulated::{PICTURE, Scenario, SimulatedGrasp};
use feeler_report::run::create_folder;
use std::fmt::Write as _;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Name of the folder of recordings.
const RECORDINGS: &str = "recordings";
/// Name of the table of labels of the grasps, next to the folder of recordings.
const LABELS: &str = "labels.csv";
/// Name of the table of labels of the frames, next to the folder of recordings.
const FRAME_LABELS: &str = "frame_labels.csv";
const LABELS_HEADER: &str = "recording,shape,mass_kg,friction,grip_force_n,shear_modulus_pa,thickness_m,irregularity,noise_px,\
     slid_m,lost,slip\n";
const FRAME_LABELS_HEADER: &str = "recording,frame,slip\n";

/// Arguments of `feeler simulate-grasps`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Number of grasps.
    #[arg(long, default_value_t = 300, value_parser = clap::value_parser!(u64).range(1..=100_000))]
    count: u64,
    /// Random seed.
    #[arg(long, default_value_t = 0, value_parser = crate::experiments::trials::parse_seed)]
    seed: u64,
    /// Number of grasps to simulate in parallel [default: number of cores]
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..=1024))]
    jobs: Option<u64>,
    /// Output folder.
    #[arg(short, long, value_name = "DIR", default_value = "grasps")]
    out: PathBuf,
    #[command(flatten)]
    overwrite: Overwrite,
}

pub fn simulate_grasps(
    arguments: &Arguments,
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    let recordings = arguments.out.join(RECORDINGS);
    create_folder(&recordings)
        .map_err(|e| format!("--out {}: {e}; expected a folder", recordings.display()))?;
    let mut outputs = Outputs::new(arguments.overwrite.force, []);
    // Opened first, because simulating takes a while.
    let labels_file = outputs.create(&arguments.out.join(LABELS), "--out")?;
    let frames_file = outputs.create(&arguments.out.join(FRAME_LABELS), "--out")?;
    let bar = Steps::new(arguments.count as usize);
    let mut labels = vec![String::new(); arguments.count as usize];
    let mut frame_labels = labels.clone();
    let (mut slips, mut done) = (0, 0);
    let interrupted = watch_for_interrupt()?;
    let simulated = |number| SimulatedGrasp::new(trial_seed(arguments.seed, number));
    let (count, jobs) = (arguments.count, jobs(arguments.jobs));
    in_parallel(count, jobs, &interrupted, simulated, |number, grasp| {
        let grasp = grasp?;
        let name = format!("{number:05}");
        write(&grasp, &name, &recordings, &mut outputs)?;
        labels[number as usize] = label(&name, &grasp);
        frame_labels[number as usize] = labels_of_frames(&name, &grasp);
        slips += u64::from(grasp.slips_at.is_some());
        done += 1;
        bar.advance();
        Ok::<_, CommandError>(())
    })?;
    drop(bar);
    let labels = LABELS_HEADER.to_owned() + &labels.concat();
    let frame_labels = FRAME_LABELS_HEADER.to_owned() + &frame_labels.concat();
    if done < arguments.count {
        // Labels of the finished grasps. The same seed yields the same grasps if the user continues later.
        let write = |file: &PartFile, text: &str| file.writer()?.write_all(text.as_bytes());
        write(&labels_file, &labels)?;
        write(&frames_file, &frame_labels)?;
        let (count, part) = (arguments.count, labels_file.part().display());
        writeln!(
            out,
            "interrupted after {done} of {count} grasps; their labels are in {part}"
        )?;
        return Ok(Outcome::GivenUp);
    }
    labels_file.finish(labels.as_bytes())?;
    frames_file.finish(frame_labels.as_bytes())?;
    writeln!(out, "{} grasps, {slips} slips", arguments.count)?;
    writeln!(out, "{}", arguments.out.display())?;
    Ok(Outcome::Done)
}

/// Writes the recording `name` and its layout.
fn write(
    grasp: &SimulatedGrasp,
    name: &str,
    folder: &Path,
    outputs: &mut Outputs,
) -> Result<(), CommandError> {
    let mut create = |end: &str| outputs.create(&folder.join(format!("{name}.{end}")), "--out");
    let (table, layout) = (create("csv")?, create("toml")?);
    table.finish(table_of(grasp).as_bytes())?;
    Ok(layout.finish(layout_of(grasp).to_toml()?.as_bytes())?)
}

/// Formats the markers' displacements and the true forces on them.
fn table_of(grasp: &SimulatedGrasp) -> String {
    let mut table = "frame,stamp,element,u_x,u_y,true_f_x,true_f_y,true_f_z\n".to_string();
    for (number, frame) in grasp.frames.iter().enumerate() {
        let stamp = frame.stamp;
        for (element, (u, f)) in frame.displaced.iter().zip(&frame.forces).enumerate() {
            // Writing to a `String` cannot fail.
            let _ = writeln!(
                table,
                "{number},{stamp:.3},{element},{:.3},{:.3},{:.5},{:.5},{:.5}",
                u.x, u.y, f.x, f.y, f.z
            );
        }
    }
    table
}

fn layout_of(grasp: &SimulatedGrasp) -> LocatedLayout {
    let place = |centre_px: &glam::DVec2| ElementPlace {
        centre_px: *centre_px,
        radius_px: grasp.scenario.gel.spacing / 2.0,
        direction: None,
        ring: None,
        ground_level: None,
    };
    LocatedLayout {
        version: LAYOUT_VERSION,
        width: PICTURE.0,
        height: PICTURE.1,
        polarity: Polarity::Dark,
        two_level: false,
        dark_level: 128,
        spot_diameter_px: None,
        dome: None,
        elements: grasp.untouched.iter().map(place).collect(),
    }
}

fn label(name: &str, grasp: &SimulatedGrasp) -> String {
    let scenario = &grasp.scenario;
    let most = grasp
        .frames
        .iter()
        .map(|frame| frame.slid)
        .fold(0.0, f64::max);
    let lost = grasp.frames.last().is_none_or(|frame| !frame.touches);
    let (lost, slip) = (u8::from(lost), u8::from(grasp.slips_at.is_some()));
    let Scenario { gel, mass, .. } = scenario;
    let gel = format!(
        "{:.0},{:.5},{:.5},{:.3}",
        gel.shear_modulus, gel.thickness, gel.irregularity, gel.noise
    );
    format!(
        "{name},{},{mass:.4},{:.3},{:.3},{gel},{most:.5},{lost},{slip}\n",
        scenario.shape_name, scenario.friction.static_friction, scenario.grip_force
    )
}

fn labels_of_frames(name: &str, grasp: &SimulatedGrasp) -> String {
    let slips = |frame: usize| grasp.slips_at.is_some_and(|first| frame >= first);
    let row = |frame| format!("{name},{frame},{}\n", u8::from(slips(frame)));
    (0..grasp.frames.len()).map(row).collect()
}
