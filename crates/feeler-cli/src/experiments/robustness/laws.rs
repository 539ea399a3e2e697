//! `feeler robustness --laws`: compares control laws on the same hands.

use super::{Arguments, entries_of_groups, even};
use crate::experiments::compare::laws::laws;
use crate::experiments::contenders::{Contender, close, contenders, run, under_law};
use crate::{CommandError, Outcome};
use feeler_lab::sweep::Plan;
use feeler_lab::sweep::analysis::{LawTrials, law_shares};
use feeler_lab::sweep::plan::ranges::Ranges;
use feeler_lab::sweep::plan::{Design, ranges};
use feeler_lab::sweep::results::write_whole;
use feeler_lab::sweep::trial::Trials;
use feeler_report::pages::{LawSharesPage, law_shares_page, percent};
use std::io::Write;

/// File name of the report.
const PAGE: &str = "laws.html";
/// File name of the report's data as JSON.
const JSON: &str = "laws.json";

/// Runs the points of the design with each law, and reports on which share of the hands each claim passes.
pub fn side_by_side(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let mut contenders = contenders(&arguments.trial, &arguments.out, trials(arguments)?)?;
    let ended = run(&arguments.trial, &mut contenders)?;
    let page = page(&contenders);
    let folder = &arguments.out;
    write_whole(&folder.join(JSON), &serde_json::to_vec_pretty(&page)?)?;
    write_whole(&folder.join(PAGE), law_shares_page(&page).as_bytes())?;
    print(&page, out)?;
    let outcome = close(contenders, ended, page.finished, out)?;
    if outcome == Outcome::Done {
        for name in [JSON, PAGE] {
            writeln!(out, "{}", folder.join(name).display())?;
        }
    }
    Ok(outcome)
}

/// Returns the trials of each law. All laws have the same design and seed, and therefore the same hands.
fn trials(
    arguments: &Arguments,
) -> Result<Vec<(String, feeler::control::law::LawConfig, Trials)>, CommandError> {
    let laws = laws(&arguments.laws, &[])?;
    let name = arguments
        .experiment
        .as_deref()
        .ok_or("--laws requires the experiment, also with --resume")?;
    let design = Design {
        rows: even(arguments.trials)?,
        controls: 0,
        pairs: 0,
    };
    let Ranges {
        set: mut settings,
        parameter,
    } = ranges::load(&arguments.ranges, name)?;
    let entries = entries_of_groups(arguments, parameter)?;
    settings.extend(arguments.trial.settings.clone());
    settings.push(format!("sensing={}", arguments.sensing));
    let trials = laws.into_iter().map(|(law_name, law)| {
        let experiment = under_law(name, &settings, &law)?;
        let law = experiment.config.control.law.clone();
        let seed = arguments.trial.seed;
        let plan = Plan::designed(&experiment, name, entries.clone(), design, seed)?;
        let trials = Trials::new(&plan)?;
        if trials.hand_claims().next().is_none() {
            return Err(format!(
                "--laws: {name} has no claims of any hand; expected an experiment that screws a cap in four strokes or more"
            )
            .into());
        }
        Ok((law_name, law, trials))
    });
    trials.collect()
}

fn page(contenders: &[Contender]) -> LawSharesPage {
    let laws: Vec<_> = contenders
        .iter()
        .map(|contender| LawTrials {
            name: &contender.name,
            trials: &contender.trials,
            table: &contender.store.table,
        })
        .collect();
    law_shares(&laws)
}

/// Prints the report's table.
fn print(page: &LawSharesPage, out: &mut dyn Write) -> std::io::Result<()> {
    writeln!(out, "{} hands at {} points", page.hands, page.finished)?;
    let of = page.laws.first().map_or(&[][..], |law| &law.shares);
    let names: String = of
        .iter()
        .map(|share| format!("  {:<22}", share.of))
        .collect();
    writeln!(out, "{:<24}{}", "passes in", names.trim_end())?;
    for law in &page.laws {
        let shares = law.shares.iter();
        let shares: String = shares
            .map(|share| format!("  {:<22}", percent(share.share)))
            .collect();
        writeln!(out, "{:<24}{}", law.law, shares.trim_end())?;
        if law.refused > 0 {
            writeln!(
                out,
                "  {} rejects {} of them, which count as failed",
                law.law, law.refused
            )?;
        }
    }
    Ok(())
}
