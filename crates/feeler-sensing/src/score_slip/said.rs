//! Formats scores as text.

use super::scores::Scored;
use feeler_report::pages::{
    GRASP_COLUMNS, GraspSlipPage, GraspTiming, GraspTransfer, TIMING_COLUMNS, TRANSFER_COLUMNS,
    base_rate,
};
use std::collections::BTreeMap;
use std::io::Write;

/// Maximum number of misjudged recordings listed on standard output for each detector.
const NAMED: usize = 12;

/// Lists the recordings that a detector misjudged, or the number of misjudged frames of each.
pub fn wrong(scored: &[Scored], detector: usize) -> Vec<String> {
    let mut wrong: BTreeMap<&str, (usize, bool)> = BTreeMap::new();
    let all = scored
        .iter()
        .filter(|s| s.verdicts[detector].is_some_and(|v| v.says_slip != s.slip));
    for one in all {
        let (count, slip) = wrong.entry(&one.recording).or_insert((0, one.slip));
        *count += 1;
        *slip = one.slip;
    }
    let frames = scored.iter().any(|s| s.frame.is_some());
    let words = |(name, (count, slip)): (&str, (usize, bool))| match (frames, slip) {
        (true, _) => format!("{name}: {count} frames"),
        (false, true) => format!("{name}: missed slip"),
        (false, false) => format!("{name}: false alarm"),
    };
    wrong.into_iter().map(words).collect()
}

/// Writes the content of the page as text.
pub fn say(page: &GraspSlipPage, out: &mut dyn Write) -> std::io::Result<()> {
    let (all, slips, groups) = page.counts;
    let base = 100.0 * base_rate(all, slips);
    writeln!(
        out,
        "{all} {} in {groups} groups, {slips} slips; always giving the more frequent label is right in {base:.1} %",
        page.of
    )?;
    if let Some((name, all, slips)) = &page.others {
        writeln!(
            out,
            "thresholds from {name}: {all} {}, {slips} slips",
            page.of
        )?;
    }
    for detector in &page.detectors {
        writeln!(out, "{}", detector.name)?;
        for (column, field) in GRASP_COLUMNS.iter().zip(detector.fields()) {
            writeln!(out, "  {column:<22} {field}")?;
        }
        let times = detector.timing.iter().flat_map(GraspTiming::fields);
        for (column, field) in TIMING_COLUMNS.iter().zip(times) {
            writeln!(out, "  {column:<22} {field}")?;
        }
        let transferred = detector.transfer.iter().flat_map(GraspTransfer::fields);
        for (column, field) in TRANSFER_COLUMNS.iter().zip(transferred) {
            writeln!(out, "  {column:<22} {field}")?;
        }
        for wrong in detector.wrong.iter().take(NAMED) {
            writeln!(out, "  {:<22} {wrong}", "wrong")?;
        }
        if let Some(more) = detector.wrong.len().checked_sub(NAMED + 1) {
            writeln!(out, "  {:<22} and {} more, on the page", "wrong", more + 1)?;
        }
    }
    Ok(())
}
