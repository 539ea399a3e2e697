//! Scores all entries on one data set.

use super::LeagueOptions;
use super::data::{DataSet, Fold, split};
use super::definition::{Definition, Split};
use super::entries::{Entry, Inputs, Task};
use super::output::content;
use super::read::read;
use super::scores::{Metric, metric_names, metrics};
use super::sets::SetFiles;
use crate::score_slip::in_order;
use feeler_console::Steps;
use feeler_report::pages::{LeagueRow, LeagueSet, PublishedFigure};
use std::path::Path;

/// Scores all entries on a data set. Advances `bar` after reading the data, and after each entry.
pub fn score(
    found: &SetFiles,
    programs: &[Entry],
    options: &LeagueOptions,
    bar: &Steps,
) -> LeagueSet {
    let entries = Entry::all(found.definition.slip.is_some(), programs);
    let mut scored = described(&found.definition);
    let set = prepared(found, &options.data, &mut scored);
    bar.advance();
    match set {
        Ok((set, folds)) => run_all(found, &set, &folds, &entries, options, |row| {
            scored.rows.push(row);
            bar.advance();
        }),
        Err(error) => {
            scored.failed = Some(error);
            entries.iter().for_each(|_| bar.advance());
        }
    }
    scored
}

/// Describes a data set, without results.
fn described(definition: &Definition) -> LeagueSet {
    let published = definition
        .published
        .iter()
        .map(|published| PublishedFigure {
            metric: published.metric.clone(),
            value: published.value.clone(),
            source: published.source.clone(),
        });
    LeagueSet {
        name: definition.name.clone(),
        title: definition.title.clone(),
        source: definition.source.clone(),
        licence: definition.licence.clone(),
        metrics: metric_names(definition),
        published: published.collect(),
        ..LeagueSet::default()
    }
}

/// Reads and splits a data set, and describes both in `scored`.
///
/// # Errors
/// If a file cannot be read, or the data are too few to split.
fn prepared(
    found: &SetFiles,
    data: &Path,
    scored: &mut LeagueSet,
) -> Result<(DataSet, Vec<Fold>), String> {
    let definition = &found.definition;
    // Results do not depend on the place of the data.
    let prefix = format!("{}{}", data.display(), std::path::MAIN_SEPARATOR);
    let set = read(definition, &found.folder);
    let set = set.map_err(|error| error.to_string().replace(&prefix, ""))?;
    let lengths = set.recordings.iter().map(|r| (r.group, r.rows.len()));
    let folds = split(
        definition.split,
        &lengths.collect::<Vec<_>>(),
        set.groups.len(),
    );
    scored.content = content(&set);
    scored.split = split_words(definition.split, folds.len());
    scored.digest.clone_from(&set.digest);
    scored.notes = set
        .notes
        .iter()
        .map(|note| note.replace(&prefix, ""))
        .collect();
    match folds.is_empty() {
        true => Err("too few groups or rows to train and to test".into()),
        false => Ok((set, folds)),
    }
}

/// Runs all entries in parallel, and passes their results to `take` in order.
fn run_all(
    found: &SetFiles,
    set: &DataSet,
    folds: &[Fold],
    entries: &[Entry],
    options: &LeagueOptions,
    mut take: impl FnMut(LeagueRow),
) {
    let definition = &found.definition;
    let inputs = definition.values.is_some().then(|| Inputs::of(set));
    let targets = definition
        .values
        .as_ref()
        .map(|values| values.targets.as_slice());
    let task = Task {
        name: &definition.name,
        set,
        folds,
        targets: targets.unwrap_or_default(),
        inputs: inputs.as_ref(),
        limit: options.limit,
    };
    let run = |entry: &Entry| {
        let answers = task.run(entry);
        answers.map(|answers| metrics(definition, set, folds, &answers))
    };
    let ran: Result<(), ()> = in_order(entries, run, |entry, result| {
        take(row(entry, result, &definition.chosen_here));
        Ok(())
    });
    // No result is an error.
    let _ = ran;
}

fn row(entry: &Entry, result: Result<Vec<Metric>, String>, chosen_here: &[String]) -> LeagueRow {
    let (values, failed) = match result {
        Ok(values) => (values, None),
        Err(error) => (Vec::new(), Some(error)),
    };
    LeagueRow {
        entry: entry.name().into(),
        key: entry.key().into(),
        values,
        // A detector without a score is not made for the sensor.
        is_error: failed.is_some() && matches!(entry, Entry::Program { .. }),
        failed,
        chosen_here: chosen_here.iter().any(|key| key == entry.key()),
    }
}

fn split_words(split: Split, folds: usize) -> String {
    match split {
        Split::Group { .. } => format!("{folds} folds; each leaves whole groups out"),
        Split::Last { part } => {
            let part = 100.0 * part;
            format!("the last {part:.0} % of each recording, after training on its beginning")
        }
        Split::Blocks { .. } => format!(
            "{folds} folds of contiguous blocks, each with a tenth of a block on both sides unused"
        ),
    }
}
