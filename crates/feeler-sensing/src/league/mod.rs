//! `feeler league`: scores detectors, calibrations, baselines and programs on published data sets.

mod data;
mod definition;
mod entries;
mod options;
mod output;
mod read;
mod score;
mod scores;
mod sets;

pub use options::LeagueOptions;

use entries::{Entry, end_programs};
use feeler_console::{CommandError, Outcome, Outputs, Steps, exit_on_interrupt, print_json, warn};
use feeler_report::pages::{LeaguePage, league_page};
use feeler_report::run::make::create_folder;
use score::score;
use sets::{ENDING, SetFiles, find_sets};
use std::collections::BTreeSet;
use std::fs;
use std::io::Write;

/// Scores all entries on all data sets in a folder.
///
/// # Errors
/// If a definition is invalid, no data set is found, or an output cannot be written. Entries and data sets that fail
/// are marked in the results, and the outcome is [`Outcome::GivenUp`].
pub fn league(options: &LeagueOptions, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let programs = programs(options)?;
    let (found, missing) = chosen_sets(options)?;
    create_folder(&options.out)
        .map_err(|e| format!("--out {}: {e}; expected a folder", options.out.display()))?;
    let mut outputs = Outputs::new(options.force, []);
    let [page_path, table_path] = ["league.html", "league.csv"].map(|name| options.out.join(name));
    // Opened first, because scoring takes a long time.
    let page_file = outputs.create(&page_path, "--out")?;
    let table_file = outputs.create(&table_path, "--out")?;
    let parts = [&page_file, &table_file].map(|file| file.part().to_path_buf());
    exit_on_interrupt(move || {
        end_programs();
        for part in &parts {
            // Partial results are discarded.
            let _ = fs::remove_file(part);
        }
    })?;
    let entries = |set: &SetFiles| Entry::all(set.definition.slip.is_some(), &programs).len();
    let bar = Steps::new(found.iter().map(|set| entries(set) + 1).sum());
    let sets = found.iter().map(|set| score(set, &programs, options, &bar));
    let page = LeaguePage {
        version: env!("CARGO_PKG_VERSION").into(),
        programs: options.programs.clone(),
        sets: sets.collect(),
        missing,
    };
    drop(bar);
    for set in &page.sets {
        let notes = set.notes.iter();
        notes.for_each(|note| warn(&format!("{}: {note}", set.name)));
    }
    table_file.finish(output::csv(&page).as_bytes())?;
    page_file.finish(league_page(&page).as_bytes())?;
    if options.json {
        print_json(&output::json(&page, &page_path, &table_path), out)?;
    } else {
        output::say(&page, out)?;
        writeln!(out, "{}\n{}", page_path.display(), table_path.display())?;
    }
    Ok(match page.has_failed() {
        true => Outcome::GivenUp,
        false => Outcome::Done,
    })
}

/// Returns the data sets to use that were found, and the names of those that were not found.
///
/// # Errors
/// If a name is unknown, or no data set is found.
fn chosen_sets(options: &LeagueOptions) -> Result<(Vec<SetFiles>, Vec<String>), CommandError> {
    let mut sets = find_sets(&options.data)?;
    let known: Vec<_> = sets.iter().map(|set| &*set.definition.name).collect();
    let is_unknown = |name: &&String| !known.contains(&name.as_str());
    if let Some(unknown) = options.sets.iter().find(is_unknown) {
        let known = known.join(", ");
        return Err(format!("--set {unknown}: expected one of {known}").into());
    }
    sets.retain(|set| options.sets.is_empty() || options.sets.contains(&set.definition.name));
    let (found, missing): (Vec<_>, Vec<_>) = sets.into_iter().partition(|s| s.folder.is_dir());
    if found.is_empty() {
        let folders = missing.iter().map(|set| set.folder.display().to_string());
        // Several sets may share a folder.
        let folders: BTreeSet<_> = folders.collect();
        let folders: Vec<_> = folders.into_iter().collect();
        let (data, folders) = (options.data.display(), folders.join(", "));
        return Err(format!(
            "{data}: no set found; expected at least one of {folders}, or a definition *{ENDING}"
        )
        .into());
    }
    let missing = missing.into_iter().map(|set| set.definition.name);
    Ok((found, missing.collect()))
}

/// Returns the user's programs as entries.
///
/// # Errors
/// If a name is that of another entry.
fn programs(options: &LeagueOptions) -> Result<Vec<Entry>, CommandError> {
    let built_in = [true, false].map(|slip| Entry::all(slip, &[])).concat();
    let names = built_in
        .iter()
        .flat_map(|entry| [entry.name(), entry.key()]);
    let mut taken: Vec<_> = names.collect();
    let mut programs = Vec::new();
    for (name, command) in &options.programs {
        if taken.contains(&name.as_str()) {
            let message = format!("--entry {name}: expected a name that no other entry has");
            return Err(message.into());
        }
        taken.push(name);
        let (name, command) = (name.clone(), command.clone());
        programs.push(Entry::Program { name, command });
    }
    Ok(programs)
}
