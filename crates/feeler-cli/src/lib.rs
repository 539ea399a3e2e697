#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

mod calibrate;
mod camera;
mod cameras;
mod check;
mod compare;
mod completions;
mod contenders;
mod drives;
#[cfg_attr(
    not(all(feature = "drives", target_os = "linux")),
    path = "no_emulated.rs"
)]
mod emulated;
mod export;
mod help;
mod identify;
mod init;
mod link;
mod list;
mod locate;
mod locate_preview;
#[cfg(not(feature = "top"))]
mod no_screen;
mod options;
mod replay;
mod report;
mod robustness;
mod ros2;
mod ros2_rig;
mod run;
mod run_progress;
mod schema;
mod score_slip;
mod sense;
mod simulate_grasps;
mod sweep;
mod throttle;
mod trials;
mod tune;
mod urdf;
mod view;
mod watcher;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use feeler_console::Output;
use std::io::{Write, stderr, stdout};
use std::process::ExitCode;

const EXAMPLES: &str = "\
Examples:
  feeler run cap-closing                      simulate the reference experiment, with pictures
  feeler run cap-closing --sensing direct --seed 7 --out runs/seven
  feeler run cap-closing --top                watch it: flags, forces, phase and programs
  feeler run cap-closing --view               watch it in the browser
  feeler run my.toml --set control.slip_threshold=2.5 --set task.screw.strokes=3
  feeler view runs/seven                      look at a recording in the browser
  feeler init my.toml                         write an experiment of your own to start from
  feeler check my.toml                        report what is wrong with an experiment file
  feeler report runs/seven                    make a run's report again from its recording
  feeler run cap-closing --record-frames --out runs/seen
  feeler replay runs/seen --from frames       pictures -> forces -> flags -> commands again, compared bit for bit
  feeler replay runs/seven --from forces --set control.slip_threshold=2.5 --out runs/what-if
  feeler export parquet runs/seven -o seven.parquet
  feeler export lerobot runs/* -o data-set    each run an episode, for imitation learning
  feeler calibrate --simulated --experiment my.toml -o my.calibration.toml
  feeler sweep cap-closing --sensing direct --vary 'friction=uniform(0.3,1.2)' -o sweep
  feeler compare cap-closing -o compare       the paper's control law against others, on the same trials
  feeler robustness cap-closing -o robustness how much of it is luck of parameters
  feeler tune my.toml --identified identified.toml --search 60 -o tuned.toml
  feeler identify cap-closing                 estimate a hand and its object by touch
  feeler locate untouched.png -o layout.toml --preview found.png
  feeler sense pictures/ --calibration my.calibration.toml -o forces.csv
  feeler sense xela_sensor1.csv --taxels uskin-4x4 -o forces.csv
  feeler sense touch.mp4 --layout layout.toml -o moments.csv

The book, in docs/ of the repository (`mdbook serve` shows it):
  first-run.md                                what a run shows, and how to read its report
  calibration.md, own-hand.md, write-a-task.md  a fingertip, a hand and a task of your own
  recordings.md                               what is in a recording; Python, Rust, viewers, replay
  multiple-programs.md                        several programs and computers
  simulator.md, claims.md                     how the simulator works; how the claims are measured";

/// Tri-axial touch to finger motion, and a simulated hand to try it on.
///
/// Exit status: 0 done; 1 the task was given up or interrupted, or a replay differs; 2 bad input.
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
    /// Run many randomised trials of an experiment; a table and a summary.
    Sweep(sweep::Arguments),
    /// Run all control laws on the same randomised trials; a page that compares them.
    Compare(compare::Arguments),
    /// Vary uncertain parameters over plausible ranges: how often each claim holds, and what decides it.
    Robustness(robustness::Arguments),
    /// Tune control and task of a screwing hand for its identified values; a new experiment file.
    Tune(tune::Arguments),
    /// Probe a hand: estimate stiffness, friction, lag, and the object's pivot and radius, with intervals.
    Identify(identify::Arguments),
    /// Score slip detectors against the simulator's truth; a page with their characteristics.
    ScoreSlip(score_slip::Arguments),
    /// Simulate grasps that hold or slip, as recordings with labels, for training slip detectors.
    SimulateGrasps(simulate_grasps::Arguments),
    /// List the built-in experiments and taxel arrays.
    List(list::Arguments),
    /// Write an experiment file of your own, with its calibration beside it, to start from.
    Init(init::Arguments),
    /// Check an experiment file without running it.
    Check(check::Arguments),
    /// Make a run's report again, from its recording alone.
    Report(report::Arguments),
    /// Replay a recording through the sensor stage, the control stage or both, and compare bit for bit.
    Replay(replay::Arguments),
    /// Look for servos on a bus, check and home them, turn one; or emulate a bus of them.
    Drives(drives::Arguments),
    /// Export recordings as tables or data sets for other programs.
    Export(export::Arguments),
    /// List the cameras that are there, and what they can do.
    Cameras(cameras::Arguments),
    /// Calibrate a fingertip: load its elements, take pictures, fit.
    Calibrate(calibrate::Arguments),
    /// Find the sensing elements in pictures of an untouched sensor.
    Locate(locate::Arguments),
    /// Simulate an experiment's rig (cameras, encoders, drives) for separate sensor and hand programs.
    World(link::world::Arguments),
    /// Serve servos on a bus, real or emulated, as the rig of separate sensor and hand programs.
    Rig(link::rig::Arguments),
    /// Control a hand whose sensors and drives are in other programs.
    Hand(link::hand::Arguments),
    /// Show a running rig of several programs on the terminal.
    Top(link::top::Arguments),
    /// Show a recording, or a running rig of several programs, in the browser.
    View(view::Arguments),
    /// Make a running rig, or a recording, appear as a node in a ROS 2 graph over Zenoh.
    Ros2(ros2::Arguments),
    /// Let a robot of ros2_control be the hand of an experiment, and sensors of its ROS 2 graph the fingertips.
    Ros2Rig(ros2_rig::Arguments),
    /// Stop the hand of a rig, from anywhere.
    Stop(link::orders::StopArguments),
    /// Resume a hand that was stopped.
    Resume(link::orders::ResumeArguments),
    /// Make the certificates by which a lab's computers authenticate each other.
    Certificates(link::certificates::Arguments),
    /// Measure this computer.
    Bench(link::bench::Arguments),
    /// Print the ROS 2 message definitions of recordings and of the link between programs.
    Schema(schema::Arguments),
    /// Print the hand of an experiment as URDF, for viewers and planners.
    Urdf(urdf::Arguments),
    /// Sense forces: from pictures, a camera or a recorded run to a table of the force on each element.
    Sense(Box<sense::Arguments>),
    /// Print completions of commands and options for a shell.
    Completions(completions::CompletionsArguments),
    /// Print a page of the manual, for man: feeler man | man -l -
    Man(completions::ManArguments),
}

use feeler_console::Outcome;

type CommandError = feeler_console::CommandError;

/// Runs the program on the process's arguments.
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
            // Where nobody listens, the exit status says it.
            let _ = writeln!(stderr(), "feeler: {error}");
            ExitCode::from(2)
        }
    }
}

/// The program's command line. A value may be negative, so that -1 is refused for what it is and not taken for an option.
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
        Command::ScoreSlip(arguments) => score_slip::score_slip(&arguments, out),
        Command::SimulateGrasps(arguments) => simulate_grasps::simulate_grasps(&arguments, out),
        Command::List(arguments) => list::list(&arguments, out),
        Command::Init(arguments) => init::init(&arguments, out),
        Command::Check(arguments) => check::check(&arguments, out),
        Command::Report(arguments) => report::report(&arguments, out),
        Command::Replay(arguments) => replay::replay(&arguments, out),
        Command::Drives(arguments) => drives::drives(&arguments, out),
        Command::Export(arguments) => export::export(&arguments, out),
        Command::Cameras(arguments) => cameras::cameras(&arguments, out),
        Command::Calibrate(arguments) => calibrate::calibrate(&arguments, out),
        Command::Locate(arguments) => locate::locate(&arguments, out),
        Command::Bench(arguments) => link::bench::bench(&arguments, out),
        Command::World(arguments) => link::world::world(&arguments, out),
        Command::Rig(arguments) => link::rig::rig(&arguments, out),
        Command::Hand(arguments) => link::hand::hand(&arguments, out),
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

/// Ends the tests where what must not allocate does.
#[cfg(test)]
#[global_allocator]
static ALLOCATOR: assert_no_alloc::AllocDisabler = assert_no_alloc::AllocDisabler;

#[cfg(test)]
mod tests {
    use super::command_line;

    /// Without debug assertions, clap lets one argument's value stand for another of the same name.
    #[test]
    fn no_subcommand_has_two_arguments_of_a_name() {
        command_line().debug_assert();
    }
}
