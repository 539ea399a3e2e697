//! Arguments of the `feeler compare` subcommand.

use crate::experiments::trials::TrialArguments;
use std::path::PathBuf;

/// File name of the report.
pub const PAGE: &str = "compare.html";

const EXAMPLES: &str = "\
The trials of each law are stored as a sweep in a subfolder named after the law. Trial K draws the same values for
every law. The experiment's law keeps its settings; other laws use their defaults. A policy is named after its
file, without the extension. A comparison of grippers writes a table LAW.csv for each law instead, and cannot be
resumed.

Examples:
  feeler compare cap-closing -o compare                     all laws, 200 trials each
  feeler compare cap-closing --laws tri-axial,best --trials 2000 -o compare
  feeler compare cap-closing --policy my.safetensors        all laws and a learned policy
  feeler compare cap-closing --resume -o compare            continue an interrupted comparison
  feeler run --trial compare/best 17                        rerun one trial, with recording and report
  feeler compare grip --trials 2000 --least-grip -o grips   laws of a gripper on 2,000 unknown objects
  feeler compare grip --drives emulated -o grips-on-a-bus   the same on servos of an emulated bus
  feeler compare grip --policy a.safetensors --policy b.safetensors     two learned policies of a gripper";

#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// Experiment file or name of a built-in experiment that closes a cap or grips an object.
    pub experiment: String,
    /// Control laws to compare; the first is the reference [default: all laws without a file]
    #[arg(long, value_delimiter = ',')]
    pub laws: Vec<String>,
    /// Learned policy (safetensors) to compare with the laws. Repeatable.
    #[arg(long = "policy", value_name = "FILE")]
    pub policies: Vec<PathBuf>,
    /// Number of trials per law.
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u64).range(1..=10_000_000))]
    pub trials: u64,
    /// Also search for the least grip that holds each object (grip experiments): six more trials per object,
    /// without a bus.
    #[arg(long)]
    pub least_grip: bool,
    /// Parameter to vary, instead of friction, noise, eccentricity and seat angle. Repeatable.
    ///
    /// Figures show the results against the first parameter.
    #[arg(long = "vary", value_name = "NAME=DISTRIBUTION")]
    pub vary: Vec<String>,
    /// Source of forces: `image` (rendered camera images) or `direct` (simulated forces plus noise).
    #[arg(long, value_parser = ["image", "direct"], default_value = "direct")]
    pub sensing: String,
    /// Minimum final torque of a successful trial (N·m).
    ///
    /// The default is the mean torque that the reference law reaches.
    #[arg(long, value_name = "TORQUE", default_value_t = 0.03)]
    pub goal_torque: f64,
    /// Maximum element force of a successful trial (N).
    ///
    /// The default is the limit for damage, a quarter above F2.
    #[arg(long, value_name = "FORCE", default_value_t = 0.63)]
    pub goal_force: f64,
    /// Move a gripper with servos on an emulated bus, in simulated time.
    ///
    /// Uses the servos of the experiment's [drives], or suitable defaults.
    #[arg(long, value_name = "SERVOS", value_parser = ["emulated"])]
    pub drives: Option<String>,
    #[command(flatten)]
    pub trial: TrialArguments,
    /// Output folder.
    #[arg(short, long, value_name = "DIR", default_value = "compare")]
    pub out: PathBuf,
}
