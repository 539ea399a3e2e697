//! `feeler league`: scores detectors, calibrations, baselines and programs on published sets.

mod data;
mod definition;
mod entries;
mod options;
mod output;
mod read;
mod scores;
mod sets;

pub use options::LeagueOptions;

use crate::score_slip::in_order;
use definition::{Definition, Split};
use entries::{Course, Entry, Inputs};
use feeler_console::{CommandError, Outcome, Outputs, Steps, print_json, warn};
use feeler_report::pages::{LeaguePage, LeagueRow, LeagueSet, PublishedFigure, league_page};
use feeler_report::run::make::create_folder;
use read::read;
use scores::{metric_names, metrics};
use sets::{FoundSet, find_sets};
use std::io::Write;

/// Scores all entries on all sets in a folder.
///
/// # Errors
/// If a definition is invalid, no set is found, or an output cannot be written. Entries and sets that fail are marked in
/// the results, and the outcome is [`Outcome::GivenUp`].
pub fn league(options: &LeagueOptions, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let found = find_sets(&options.data)?;
    let programs = programs(options)?;
    let known: Vec<_> = found
        .iter()
        .map(|set| set.definition.name.as_str())
        .collect();
    if let Some(unknown) = options
        .sets
        .iter()
        .find(|name| !known.contains(&name.as_str()))
    {
        let known = known.join(", ");
        return Err(format!("--set {unknown}: expected one of {known}").into());
    }
    let wanted =
        |set: &FoundSet| options.sets.is_empty() || options.sets.contains(&set.definition.name);
    let found = found.into_iter().filter(wanted);
    let (found, missing): (Vec<_>, Vec<_>) = found.partition(|set| set.folder.is_dir());
    if found.is_empty() {
        let missing: Vec<_> = missing
            .iter()
            .map(|set| set.folder.display().to_string())
            .collect();
        let (data, missing) = (options.data.display(), missing.join(", "));
        return Err(format!(
            "{data}: no set found; expected at least one of {missing}, or a definition *{}",
            sets::ENDING
        )
        .into());
    }
    create_folder(&options.out)
        .map_err(|e| format!("--out {}: {e}; expected a folder", options.out.display()))?;
    let mut outputs = Outputs::new(options.force, [Some(options.data.as_path())]);
    let [page_path, table_path] = ["league.html", "league.csv"].map(|name| options.out.join(name));
    // Opened first, because scoring takes a long time.
    let page_file = outputs.create(&page_path, "--out")?;
    let table_file = outputs.create(&table_path, "--out")?;

    let mut page = LeaguePage {
        version: env!("CARGO_PKG_VERSION").into(),
        programs: options.programs.clone(),
        sets: Vec::new(),
        missing: missing
            .iter()
            .map(|set| set.definition.name.clone())
            .collect(),
    };
    let entries = found
        .iter()
        .map(|set| Entry::all(set.definition.slip.is_some(), &programs).len());
    let bar = Steps::new(entries.map(|count| count + 1).sum());
    for set in &found {
        page.sets.push(score(set, &programs, options, &bar));
    }
    drop(bar);
    for set in &page.sets {
        set.notes
            .iter()
            .for_each(|note| warn(&format!("{}: {note}", set.name)));
    }
    let has_failed = page.has_failed();
    table_file.finish(output::csv(&page).as_bytes())?;
    page_file.finish(league_page(&page).as_bytes())?;
    if options.json {
        print_json(&output::json(&page, &page_path, &table_path), out)?;
    } else {
        output::say(&page, out)?;
        writeln!(out, "{}\n{}", page_path.display(), table_path.display())?;
    }
    Ok(if has_failed {
        Outcome::GivenUp
    } else {
        Outcome::Done
    })
}

/// Programs as entries.
///
/// # Errors
/// If a name is that of another entry.
fn programs(options: &LeagueOptions) -> Result<Vec<Entry>, CommandError> {
    let mut taken: Vec<String> = Vec::new();
    for slip in [true, false] {
        let entries = Entry::all(slip, &[]);
        taken.extend(
            entries
                .iter()
                .flat_map(|e| [e.name().to_owned(), e.key().to_owned()]),
        );
    }
    let mut programs = Vec::new();
    for (name, command) in &options.programs {
        if taken.contains(name) {
            let message = format!("--entry {name}: expected a name that no other entry has");
            return Err(message.into());
        }
        taken.push(name.clone());
        let (name, command) = (name.clone(), command.clone());
        programs.push(Entry::Program { name, command });
    }
    Ok(programs)
}

/// Scores all entries on a set.
fn score(found: &FoundSet, programs: &[Entry], options: &LeagueOptions, bar: &Steps) -> LeagueSet {
    let definition = &found.definition;
    let entries = Entry::all(definition.slip.is_some(), programs);
    let published = definition
        .published
        .iter()
        .map(|published| PublishedFigure {
            metric: published.metric.clone(),
            value: published.value.clone(),
            source: published.source.clone(),
        });
    let mut scored = LeagueSet {
        name: definition.name.clone(),
        title: definition.title.clone(),
        source: definition.source.clone(),
        licence: definition.licence.clone(),
        content: String::new(),
        split: String::new(),
        digest: String::new(),
        metrics: metric_names(definition),
        rows: Vec::new(),
        published: published.collect(),
        failed: None,
        notes: Vec::new(),
    };
    // Errors are converted to text because they are not `Send`.
    let set = read(definition, &found.folder).map_err(|e| e.to_string());
    bar.advance();
    let set = match set {
        Ok(set) => set,
        Err(error) => {
            scored.failed = Some(error);
            entries.iter().for_each(|_| bar.advance());
            return scored;
        }
    };
    let lengths = set.recordings.iter().map(|r| (r.group, r.rows.len()));
    let folds = data::split(
        definition.split,
        &lengths.collect::<Vec<_>>(),
        set.groups.len(),
    );
    scored.content = output::content(&set);
    scored.split = split_words(definition, folds.len());
    scored.digest.clone_from(&set.digest);
    scored.notes.clone_from(&set.notes);
    if folds.is_empty() {
        scored.failed = Some("too few groups or rows to train and test".into());
        entries.iter().for_each(|_| bar.advance());
        return scored;
    }
    let inputs = definition.values.is_some().then(|| Inputs::of(&set));
    let course = Course {
        name: &definition.name,
        set: &set,
        folds: &folds,
        targets: definition
            .values
            .as_ref()
            .map_or(&[], |values| &values.targets),
        inputs: inputs.as_ref(),
        limit: options.limit,
    };
    let run = |entry: &Entry| match course.run(entry) {
        Ok(answers) => Ok(metrics(definition, &set, &folds, &answers)),
        Err(error) => Err(error),
    };
    let _: Result<(), ()> = in_order(&entries, run, |entry, result| {
        let (values, failed) = match result {
            Ok(metrics) => (
                metrics.into_iter().map(|metric| metric.value).collect(),
                None,
            ),
            Err(error) => (Vec::new(), Some(error)),
        };
        scored.rows.push(LeagueRow {
            entry: entry.name().into(),
            key: entry.key().into(),
            values,
            // A detector without a score is not made for the sensor.
            is_error: failed.is_some() && matches!(entry, Entry::Program { .. }),
            failed,
            chosen_here: definition.chosen_here.iter().any(|key| key == entry.key()),
        });
        bar.advance();
        Ok(())
    });
    scored
}

fn split_words(definition: &Definition, folds: usize) -> String {
    match definition.split {
        Split::Group { .. } => format!("{folds} folds; each leaves whole groups out"),
        Split::Last { part } => {
            let part = 100.0 * part;
            format!("the last {part:.0} % of each recording, after training on its beginning")
        }
        Split::Blocks { .. } => {
            format!(
                "{folds} folds of contiguous blocks, each with a tenth of a block around it unused"
            )
        }
    }
}
