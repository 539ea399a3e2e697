//! The `feeler robustness` subcommand.

mod laws;

use super::trials::TrialArguments;
use crate::{CommandError, Outcome};
use feeler_lab::config::Experiment;
use feeler_lab::sweep::analysis::robustness as judge;
use feeler_lab::sweep::plan::ranges::{Entry, Ranges};
use feeler_lab::sweep::plan::{Design, MAX_ROWS, ranges};
use feeler_lab::sweep::results::{TRIALS, write_whole};
use feeler_lab::sweep::trial::Trials;
use feeler_lab::sweep::{Ended, Plan};
use feeler_report::DecidedBy;
use feeler_report::pages::{Measure, RobustnessPage, decided_by, percent, robustness_page};
use std::collections::BTreeSet;
use std::io::Write;
use std::path::PathBuf;

/// File name of the report.
const PAGE: &str = "robustness.html";
/// File name of the report's data as JSON.
const JSON: &str = "robustness.json";
/// Value of `--group`, and name of the runs, in which all groups vary.
const ALL: &str = "all";
/// Maximum number of deciding parameters printed per claim.
const NAMED: usize = 3;

const EXAMPLES: &str = "\
A file of ranges specifies the plausible range of each value, with a justification. The ranges of cap-closing are in
crates/feeler-lab/experiments/cap-closing.robustness.toml. Number of runs: the trials, the controls for each group, and for the sensitivity
indices one run for each pair and each parameter, group and seed.

Examples:
  feeler robustness cap-closing -o robustness
  feeler robustness cap-closing --group tuning -o tuning     only settings chosen by an engineer
  feeler robustness cap-closing --trials 8192 --sensitivity 0 -o shares
  feeler robustness my.toml --ranges my.robustness.toml -o mine
  feeler robustness cap-closing --ranges rubber.toml --sensitivity 0 -o rubber
  feeler robustness cap-closing --laws tri-axial,best --group apparatus --trials 400 -o laws
  feeler robustness --resume -o robustness                   continue an interrupted study
  feeler run --trial robustness 17                           rerun one trial, with recording and report";

#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// Experiment file or name of a built-in experiment; optional with --resume.
    #[arg(required_unless_present = "resume")]
    experiment: Option<String>,
    /// File of ranges (TOML). Repeatable, to combine files [default: the ranges of the experiment]
    #[arg(long, value_name = "FILE")]
    ranges: Vec<PathBuf>,
    /// Groups of ranges to vary, e.g. apparatus or tuning, or `all`.
    #[arg(long, value_name = "GROUP,…", value_delimiter = ',', default_value = ALL)]
    group: Vec<String>,
    /// Control laws to compare on the same hands, e.g. tri-axial,best.
    ///
    /// The report shows the share of hands on which each law passes the five claims of any hand.
    #[arg(long, value_name = "LAW,…", value_delimiter = ',', conflicts_with_all = ["controls", "sensitivity"])]
    laws: Vec<String>,
    /// Number of points at which everything varies; must be even.
    #[arg(long, default_value_t = 2048, value_parser = clap::value_parser!(u64).range(2..=MAX_ROWS))]
    trials: u64,
    /// Number of runs in which a single group varies, and of runs in which nothing varies.
    #[arg(long, default_value_t = 512, value_parser = clap::value_parser!(u64).range(..=MAX_ROWS))]
    controls: u64,
    /// Number of pairs of points for estimating sensitivity indices; 0 disables them.
    #[arg(long, value_name = "PAIRS", default_value_t = 256, value_parser = clap::value_parser!(u64).range(..=MAX_ROWS / 2))]
    sensitivity: u64,
    /// Source of forces: `image` (rendered camera images) or `direct` (simulated forces plus noise).
    #[arg(long, value_parser = ["image", "direct"], default_value = "direct")]
    sensing: String,
    #[command(flatten)]
    trial: TrialArguments,
    /// Output folder of table and report.
    #[arg(short, long, value_name = "DIR", default_value = "robustness")]
    out: PathBuf,
}

pub fn robustness(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    if !arguments.laws.is_empty() {
        return laws::side_by_side(arguments, out);
    }
    let plan = plan(arguments)?;
    let trials = Trials::new(&plan)?;
    let folder = &arguments.out;
    let mut store = arguments.trial.store(folder, &trials)?;
    let ended = arguments.trial.run(&trials, &mut store)?;
    let page = judge(&trials, &store.table);
    let json = serde_json::to_vec_pretty(&page)?;
    write_whole(&folder.join(JSON), &json)?;
    write_whole(&folder.join(PAGE), robustness_page(&page).as_bytes())?;
    print(&page, out)?;
    if ended == Ended::Stopped {
        let (finished, folder) = (page.finished, folder.display());
        writeln!(
            out,
            "interrupted: {finished} of {} trials are finished and saved; continue with `feeler robustness --resume -o {folder}`",
            page.planned
        )?;
        return Ok(Outcome::GivenUp);
    }
    store.finish()?;
    for name in [TRIALS, JSON, PAGE] {
        writeln!(out, "{}", folder.join(name).display())?;
    }
    Ok(Outcome::Done)
}

/// Returns the plan: from the command line, or with `--resume` from the folder.
fn plan(arguments: &Arguments) -> Result<Plan, CommandError> {
    let folder = arguments.out.display();
    let kept = match arguments.trial.resume {
        true => Some(Plan::read(&arguments.out)?),
        false => None,
    };
    if kept.as_ref().is_some_and(|kept| kept.design.is_none()) {
        return Err(format!(
            "--resume -o {folder}: the folder contains a sweep; expected an interrupted `feeler robustness`"
        )
        .into());
    }
    let Some(name) = &arguments.experiment else {
        let others = !arguments.ranges.is_empty() || !arguments.trial.settings.is_empty();
        return match kept {
            Some(kept) if !others => Ok(kept),
            _ => Err("--resume without an experiment accepts no other options; name the experiment to check them against the stored plan".into()),
        };
    };
    let new = new_plan(arguments, name)?;
    let Some(kept) = kept else { return Ok(new) };
    match kept.difference(&new) {
        None => Ok(kept),
        Some(difference) => Err(format!(
            "--resume -o {folder}: {difference}; expected the interrupted study, unchanged"
        )
        .into()),
    }
}

fn new_plan(arguments: &Arguments, name: &str) -> Result<Plan, CommandError> {
    let design = Design {
        rows: arguments.trials,
        controls: arguments.controls,
        pairs: arguments.sensitivity,
    };
    let Design {
        rows,
        controls,
        pairs,
    } = design;
    if rows % 2 != 0 || controls > rows || 2 * pairs > rows {
        return Err(format!(
            "--trials {rows} --controls {controls} --sensitivity {pairs}: expected an even number of trials, at most as many controls, and at most half as many pairs"
        )
        .into());
    }
    let Ranges {
        set: mut settings,
        parameter,
    } = ranges::load(&arguments.ranges, name)?;
    settings.extend(arguments.trial.settings.clone());
    settings.push(format!("sensing={}", arguments.sensing));
    let experiment = Experiment::load(name, &settings)?;
    let entries = entries_of_groups(arguments, parameter)?;
    Ok(Plan::designed(
        &experiment,
        name,
        entries,
        design,
        arguments.trial.seed,
    )?)
}

/// Returns the ranges of the groups that vary.
fn entries_of_groups(
    arguments: &Arguments,
    mut entries: Vec<Entry>,
) -> Result<Vec<Entry>, CommandError> {
    let groups: BTreeSet<_> = entries.iter().map(|entry| entry.group.clone()).collect();
    let unknown = (arguments.group.iter()).find(|&group| group != ALL && !groups.contains(group));
    if let Some(group) = unknown {
        let groups: Vec<_> = groups.into_iter().collect();
        let groups = groups.join(", ");
        return Err(format!("--group {group}: unknown group; expected {ALL}, {groups}").into());
    }
    let varies = |group: &String| arguments.group.iter().any(|g| g == ALL || g == group);
    entries.retain(|entry| varies(&entry.group));
    Ok(entries)
}

/// Rejects an odd number of trials.
fn even(trials: u64) -> Result<u64, CommandError> {
    match trials % 2 {
        0 => Ok(trials),
        _ => Err(format!("--trials {trials}: expected an even number").into()),
    }
}

/// Prints the share of hands on which each claim passes, and the parameters that influence it most.
fn print(page: &RobustnessPage, out: &mut dyn Write) -> std::io::Result<()> {
    let infeasible = page.rows - page.hands;
    writeln!(
        out,
        "{} hands at {} points ({infeasible} infeasible)",
        page.hands, page.rows
    )?;
    let name = |measure: &Measure| match measure.decided_by {
        Some(by @ DecidedBy::HandAndBottle) => format!("{} ({})", measure.name, decided_by(by)),
        _ => measure.name.clone(),
    };
    let widest = page.measures.iter().map(|m| name(m).chars().count()).max();
    let widest = widest.unwrap_or(0);
    let legend = page.measures.first().map_or(&[][..], |m| &m.shares);
    let names: String = legend
        .iter()
        .map(|share| format!("  {:<22}", share.of))
        .collect();
    writeln!(
        out,
        "{:widest$}{names}  decided by (total effect, %)",
        "passes in"
    )?;
    for measure in &page.measures {
        let shares = measure
            .shares
            .iter()
            .map(|share| format!("  {:<22}", percent(share.share)));
        let deciding = measure.deciding(page.parameters).into_iter().take(NAMED);
        let deciding: Vec<_> = deciding
            .map(|(name, total)| format!("{name} {:.0}", 100.0 * total))
            .collect();
        let shares: String = shares.collect();
        writeln!(
            out,
            "{:widest$}{shares}  {}",
            name(measure),
            deciding.join("; ")
        )?;
    }
    Ok(())
}
