#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

mod calibrate;
mod camera;
mod cameras;
mod completions;
mod drives;
#[cfg_attr(
    not(all(feature = "drives", target_os = "linux")),
    path = "no_emulated.rs"
)]
mod emulated;
pub mod experiments;
mod export;
mod follow;
mod help;
mod league;
mod link;
mod locate;
mod locate_preview;
#[cfg(not(feature = "top"))]
mod no_screen;
mod options;
mod ros2;
mod ros2_rig;
mod schema;
mod score_slip;
mod sense;
mod skins;
#[cfg(any(target_os = "linux", feature = "drives"))]
mod typed;
mod urdf;
mod verify;
mod view;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use experiments::{
    check, compare, identify, init, list, replay, report, robustness, run, simulate_grasps, sweep,
    tune,
};
use feeler_console::Output;
use std::io::{Write, stderr, stdout};
use std::process::ExitCode;

const EXAMPLES: &str = "\
Examples:
  feeler run cap-closing                      simulate the reference experiment with camera images
  feeler run cap-closing --sensing direct --seed 7 --out runs/seven
  feeler run cap-closing --top                watch flags, forces, phase and programs
  feeler run cap-closing --view               watch it in the browser
  feeler run my.toml --set control.slip_threshold=2.5 --set task.screw.strokes=3
  feeler view runs/seven                      look at a recording in the browser
  feeler init my.toml                         create an experiment file to start from
  feeler check my.toml                        validate an experiment file
  feeler report runs/seven                    rebuild a report from its recording
  feeler run cap-closing --record-frames --out runs/seen
  feeler replay runs/seen --from frames       replay images -> forces -> flags -> commands, compared bit for bit
  feeler replay runs/seven --from forces --set control.slip_threshold=2.5 --out runs/what-if
  feeler export parquet runs/seven -o seven.parquet
  feeler export lerobot runs/* -o data-set    one episode per run, for imitation learning
  feeler calibrate --simulated --experiment my.toml -o my.calibration.toml
  feeler sweep cap-closing --sensing direct --vary 'friction=uniform(0.3,1.2)' -o sweep
  feeler compare cap-closing -o compare       the paper's control law against others on the same trials
  feeler robustness cap-closing -o robustness sensitivity of the results to parameters
  feeler tune my.toml --identified identified.toml --search 60 -o tuned.toml
  feeler identify cap-closing                 estimate a hand and its object by probing
  feeler locate untouched.png -o layout.toml --preview found.png
  feeler sense images/ --calibration my.calibration.toml -o forces.csv
  feeler sense xela_sensor1.csv --taxels uskin-4x4 -o forces.csv
  feeler sense serial:/dev/ttyACM0 --taxels anyskin
  feeler sense touch.mp4 --layout layout.toml -o moments.csv
  feeler league data/                         compare detectors and calibrations on published recordings

The book, in docs/ of the repository (`mdbook serve` shows it):
  first-run.md                                a first run and its report
  calibration.md, own-hand.md, write-a-task.md  custom fingertips, hands and tasks
  recordings.md                               recording format; Python, Rust, viewers, replay
  multiple-programs.md                        several programs and computers
  simulator.md, claims.md                     simulator model; definition of the claims";

/// Tactile sensing and control with soft tri-axial fingertips, on a real or simulated hand.
///
/// Exit status: 0 success; 1 the task was given up or interrupted, a replay differs, or a calibration is no longer valid; 2 invalid input.
#[derive(Debug, Parser)]
#[command(name = "feeler", version, after_help = EXAMPLES)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run an experiment and write its recording, report and summary.
    Run(run::Arguments),
    /// Run randomised trials of an experiment and summarise them.
    Sweep(sweep::Arguments),
    /// Compare control laws on the same randomised trials.
    Compare(compare::Arguments),
    /// Measure how often each claim passes over plausible parameter ranges, and which parameters decide.
    Robustness(robustness::Arguments),
    /// Tune the control and task settings of a screwing hand to its identified values.
    Tune(tune::Arguments),
    /// Estimate a hand's stiffness, friction and lag, and its object's pivot and radius, by probing.
    Identify(identify::Arguments),
    /// Score slip detectors on simulated runs or labelled recordings.
    ScoreSlip(score_slip::Arguments),
    /// Compare slip detectors, calibrations and your own programs on published recordings.
    League(league::Arguments),
    /// Simulate labelled grasps, held or slipping, for training slip detectors.
    ///
    /// Writes tables for `feeler sense`, each with its layout, to DIR/recordings. DIR/labels.csv contains a label per
    /// grasp (1 if the object slid by more than 4 mm or was lost), DIR/frame_labels.csv a label per frame. Score them
    /// with `feeler score-slip DIR/recordings DIR/labels.csv`, or pass both to its --thresholds-from.
    SimulateGrasps(simulate_grasps::Arguments),
    /// List the built-in experiments and taxel arrays.
    List(list::Arguments),
    /// Create an experiment file, with its calibration, to start from.
    Init(init::Arguments),
    /// Check an experiment file without running it.
    Check(check::Arguments),
    /// Rebuild a run's report from its recording.
    Report(report::Arguments),
    /// Replay a recording through sensing, control or both, and compare bit for bit.
    Replay(replay::Arguments),
    /// Scan, check, home and jog servos on a bus, or emulate a bus.
    Drives(drives::Arguments),
    /// Export recordings as tables or data sets.
    Export(export::Arguments),
    /// List the available cameras and their capabilities.
    Cameras(cameras::Arguments),
    /// List the tactile skins on serial ports, or record or emulate one.
    Skins(skins::Arguments),
    /// Calibrate a fingertip from images under known loads.
    Calibrate(Box<calibrate::Arguments>),
    /// Test with a few presses whether a wrench calibration is still valid.
    Verify(verify::Arguments),
    /// Find the sensing elements in images of an unloaded sensor.
    Locate(locate::Arguments),
    /// Simulate the rig (cameras, encoders, drives) for separate sensor and hand programs.
    World(link::world::Arguments),
    /// Serve real or emulated servos to separate sensor and hand programs.
    Rig(link::rig::Arguments),
    /// Control a hand whose sensors and drives run in other programs.
    Hand(link::hand::Arguments),
    /// Move a hand at velocities that another program writes to standard input, such as LeRobot.
    Follow(Box<follow::Arguments>),
    /// Show a running rig in the terminal.
    Top(link::top::Arguments),
    /// Show a recording or a running rig in the browser.
    View(view::Arguments),
    /// Publish a running rig or a recording as a ROS 2 node over Zenoh.
    Ros2(ros2::Arguments),
    /// Use a ros2_control robot and ROS 2 tactile sensors as the rig of an experiment.
    Ros2Rig(ros2_rig::Arguments),
    /// Stop the hand of a rig.
    Stop(link::orders::StopArguments),
    /// Resume a stopped hand.
    Resume(link::orders::ResumeArguments),
    /// Issue certificates that authenticate the computers of a rig to each other.
    Certificates(link::certificates::Arguments),
    /// Measure latency on this computer.
    Bench(link::bench::Arguments),
    /// Print the ROS 2 message definitions of recordings and network messages.
    Schema(schema::Arguments),
    /// Print an experiment's hand as URDF.
    Urdf(urdf::Arguments),
    /// Measure the force on each element in images, a camera stream or a recorded run.
    Sense(Box<sense::Arguments>),
    /// Print a shell completion script.
    Completions(completions::CompletionsArguments),
    /// Print a manual page: feeler man | man -l -
    Man(completions::ManArguments),
}

use feeler_console::Outcome;

type CommandError = feeler_console::CommandError;

/// Runs the program with the process's arguments.
pub fn main() -> ExitCode {
    let matches = command_line().get_matches();
    let arguments = Arguments::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    let mut out = Output::new(stdout().lock());
    let result = run_command(arguments.command, &mut out)
        .and_then(|outcome| Ok(out.flush().map(|()| outcome)?));
    match result {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::GivenUp | Outcome::Differs) => ExitCode::from(1),
        Err(error) => {
            // If standard error is closed, the exit status still reports the failure.
            let _ = writeln!(stderr(), "feeler: {error}");
            ExitCode::from(2)
        }
    }
}

/// Builds the command line. Option values may be negative, so that -1 is rejected as a value instead of being parsed
/// as an option.
fn command_line() -> clap::Command {
    let negative = |argument: clap::Arg| {
        let is_option = argument.get_long().is_some() && argument.get_action().takes_values();
        argument.allow_negative_numbers(is_option)
    };
    let subcommand = move |command: clap::Command| command.mut_args(negative);
    help::grouped(Arguments::command().mut_subcommands(subcommand))
}

fn run_command(command: Command, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    match command {
        Command::Run(arguments) => run::run(&arguments, out),
        Command::Sweep(arguments) => sweep::sweep(&arguments, out),
        Command::Compare(arguments) => compare::compare(&arguments, out),
        Command::Robustness(arguments) => robustness::robustness(&arguments, out),
        Command::Tune(arguments) => tune::tune(&arguments, out),
        Command::Identify(arguments) => identify::identify(&arguments, out),
        Command::League(arguments) => league::league(&arguments, out),
        Command::ScoreSlip(arguments) => score_slip::score_slip(&arguments, out),
        Command::SimulateGrasps(arguments) => simulate_grasps::simulate_grasps(&arguments, out),
        Command::List(arguments) => list::list(&arguments, out),
        Command::Init(arguments) => init::init(&arguments, out),
        Command::Check(arguments) => check::check(&arguments, out),
        Command::Report(arguments) => report::report(&arguments, out),
        Command::Replay(arguments) => replay::replay(&arguments, out),
        Command::Drives(arguments) => drives::drives(&arguments, out),
        Command::Export(arguments) => export::export(&arguments, out),
        Command::Skins(arguments) => skins::skins(&arguments, out),
        Command::Cameras(arguments) => cameras::cameras(&arguments, out),
        Command::Calibrate(arguments) => calibrate::calibrate(&arguments, out),
        Command::Verify(arguments) => verify::verify(&arguments, out),
        Command::Locate(arguments) => locate::locate(&arguments, out),
        Command::Bench(arguments) => link::bench::bench(&arguments, out),
        Command::World(arguments) => link::world::world(&arguments, out),
        Command::Rig(arguments) => link::rig::rig(&arguments, out),
        Command::Hand(arguments) => link::hand::hand(&arguments, out),
        Command::Follow(arguments) => follow::follow(&arguments, out),
        Command::Top(arguments) => link::top::top(&arguments, out),
        Command::View(arguments) => view::view(&arguments, out),
        Command::Ros2(arguments) => ros2::ros2(&arguments, out),
        Command::Ros2Rig(arguments) => ros2_rig::ros2_rig(&arguments, out),
        Command::Stop(arguments) => link::orders::stop(&arguments, out),
        Command::Resume(arguments) => link::orders::resume(&arguments, out),
        Command::Certificates(arguments) => link::certificates::certificates(&arguments, out),
        Command::Schema(arguments) => schema::schema(&arguments, out),
        Command::Urdf(arguments) => urdf::print(&arguments, out),
        Command::Sense(arguments) => sense::sense(&arguments),
        Command::Completions(arguments) => completions::completions(&arguments, out),
        Command::Man(arguments) => completions::man(&arguments, out),
    }
}

/// Aborts the tests on an allocation within `assert_no_alloc`.
#[cfg(test)]
#[global_allocator]
static ALLOCATOR: assert_no_alloc::AllocDisabler = assert_no_alloc::AllocDisabler;

#[cfg(test)]
mod tests {
    use super::command_line;

    /// Without debug assertions, clap silently shares the value of two arguments of the same name.
    #[test]
    fn argument_names_are_unique() {
        command_line().debug_assert();
    }
}
