//! Results as text, table and JSON.

use super::data::{DataSet, Truth};
use feeler_report::pages::{LeaguePage, LeagueSet};
use serde_json::{Value, json};
use std::io::Write;
use std::path::Path;

/// Width of the column of metrics (characters).
const METRIC: usize = 18;
/// Width of the column of entries (characters).
const ENTRY: usize = 30;
/// Width of the column of values (characters).
const VALUE: usize = 28;

/// Describes the numbers of recordings, groups, rows and slips.
pub fn content(set: &DataSet) -> String {
    let rows: usize = set
        .recordings
        .iter()
        .map(|recording| recording.rows.len())
        .sum();
    let (recordings, groups) = (set.recordings.len(), set.groups.len());
    let mut text = format!("{recordings} recordings in {groups} groups, {rows} rows");
    let slips = set.slips.iter().filter(|slip| slip.slip).count();
    if !set.slips.is_empty() {
        let per_row = set
            .recordings
            .iter()
            .any(|r| matches!(r.truth, Truth::SlipRows(_)));
        let of = if per_row {
            "labelled rows"
        } else {
            "labelled recordings"
        };
        text += &format!("; slip in {slips} of {} {of}", set.slips.len());
    }
    text
}

/// Writes the results as text.
pub fn say(page: &LeaguePage, out: &mut dyn Write) -> std::io::Result<()> {
    for set in &page.sets {
        writeln!(out, "{}: {}", set.name, set.title)?;
        if let Some(failed) = &set.failed {
            writeln!(out, "  FAILED: {failed}\n")?;
            continue;
        }
        writeln!(out, "  {}; {}", set.content, set.split)?;
        let (metric, entry, value) = ("metric", "entry", "value [95 %]");
        writeln!(
            out,
            "  {metric:<METRIC$}{entry:<ENTRY$}{value:<VALUE$}published"
        )?;
        for index in 0..set.metrics.len() {
            say_metric(set, index, out)?;
        }
        for row in set.rows.iter().filter(|row| row.failed.is_some()) {
            let failed = row.failed.as_deref().unwrap_or_default();
            let word = if row.is_error {
                "FAILED"
            } else {
                "not applicable"
            };
            writeln!(out, "  {word}: {}: {failed}", row.entry)?;
        }
        if set.rows.iter().any(|row| row.chosen_here) {
            writeln!(out, "  * developed on these data, therefore optimistic")?;
        }
        writeln!(out)?;
    }
    if !page.missing.is_empty() {
        writeln!(out, "not found: {}", page.missing.join(", "))?;
    }
    Ok(())
}

fn say_metric(set: &LeagueSet, index: usize, out: &mut dyn Write) -> std::io::Result<()> {
    let name = set.metric_name(index);
    let published = set.published_for(index);
    let rows = set.rows.iter().filter(|row| row.failed.is_none());
    for (number, row) in rows.enumerate() {
        let name = if number == 0 { &*name } else { "" };
        let entry = format!("{}{}", row.entry, if row.chosen_here { " *" } else { "" });
        let value = set.shown(row, index);
        let published = if number == 0 { &*published } else { "" };
        let line = format!("  {name:<METRIC$}{entry:<ENTRY$}{value:<VALUE$}{published}");
        writeln!(out, "{}", line.trim_end())?;
    }
    Ok(())
}

/// Formats the results as a table: one row per data set, metric and entry.
pub fn csv(page: &LeaguePage) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    // Writing to memory cannot fail.
    let mut write = |row: [&str; 10]| drop(writer.write_record(row));
    write([
        "set",
        "digest",
        "metric",
        "unit",
        "entry",
        "value",
        "low",
        "high",
        "developed_here",
        "failed",
    ]);
    for set in &page.sets {
        if let Some(failed) = &set.failed {
            write([&set.name, &set.digest, "", "", "", "", "", "", "", failed]);
        }
        for (index, (metric, unit)) in set.metrics.iter().enumerate() {
            for row in &set.rows {
                let value = row.values.get(index).copied().flatten();
                let number = |place: usize| {
                    let number = value.map(|ends| ends[place]).filter(|end| end.is_finite());
                    number.map_or(String::new(), |number| number.to_string())
                };
                let developed = u8::from(row.chosen_here).to_string();
                let failed = row.failed.as_deref().unwrap_or_default();
                let [low, value, high] = [0, 1, 2].map(number);
                write([
                    &set.name,
                    &set.digest,
                    metric,
                    unit,
                    &row.key,
                    &value,
                    &low,
                    &high,
                    &developed,
                    failed,
                ]);
            }
        }
    }
    let bytes = writer.into_inner().unwrap_or_default();
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Formats the results as JSON.
pub fn json(page: &LeaguePage, page_path: &Path, table_path: &Path) -> Value {
    json!({
        "page": page_path, "table": table_path, "version": page.version, "sets": page.sets, "missing": page.missing,
    })
}
