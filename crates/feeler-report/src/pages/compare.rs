//! `compare.html`: comparison of control laws on the same trials, on a self-contained page.

use super::document::{
    Tile, document_of_figures, figures, folded, incomplete, number_heads, numbers, table, tiles,
};
use super::text::{name_and_unit, number, signed, significant};
use crate::figures::Figure;
use crate::figures::compare::{Curves, Pairs, curves_figure, pairs_figure};
use maud::{Markup, html};

/// Content of the comparison page.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ComparePage {
    /// Name of the experiment.
    pub name: String,
    /// Number of trials completed by every law.
    pub trials: u64,
    /// Number of planned trials.
    pub planned: u64,
    /// Success criterion: minimum torque (mN·m) and maximum element force (N).
    pub goal: (f64, f64),
    /// Results of the laws; the first is the baseline.
    pub laws: Vec<ComparedLaw>,
    /// Success and measures as functions of the varied quantities.
    pub curves: Vec<Curves>,
    /// Comparison of each other law with the first, trial by trial.
    pub pairs: Vec<Pairs>,
    /// Seed and `--vary` expressions, as on the command line.
    pub varied: String,
    /// The experiment without law and varied values.
    pub experiment: String,
}

/// Results of one law.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedLaw {
    /// Name of the law.
    pub name: String,
    /// Number of lines of code without blank lines and comments; `None` for a learned policy.
    pub lines: Option<usize>,
    /// Measures, in the same order for all laws.
    pub rows: Vec<Row>,
}

/// A measure of a law: its mean, and the mean difference from the first law in the same trials. Each is `[low, mean,
/// high]` with the 95 % confidence interval, whose ends are NaN if there is only one trial.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Name and unit of the measure.
    pub name: &'static str,
    /// Mean of the measure; `None` if unknown.
    pub value: Option<[f64; 3]>,
    /// Mean difference from the first law; `None` if unknown.
    pub difference: Option<[f64; 3]>,
}

impl ComparePage {
    /// Compares torque and peak force of a law with the first law, in one sentence; `None` for the first law.
    pub fn verdict(&self, law: usize) -> Option<String> {
        let law = self.laws.get(law).filter(|_| law > 0)?;
        let [torque, force] = [law.rows.get(1)?, law.rows.get(2)?].map(|row| row.difference);
        let (torque, force) = (torque?, force?);
        let judged = match (torque[0] > 0.0, force[2] < 0.0) {
            (true, true) => "more torque at less force",
            (true, false) if force[0] > 0.0 => "more torque at more force",
            (true, false) => "more torque at about the same force",
            (false, true) if torque[2] < 0.0 => "less force at less torque",
            (false, true) => "less force at about the same torque",
            (false, false) if torque[0].is_nan() => "not comparable on a single trial",
            (false, false) => "no clear improvement in either",
        };
        let first = self.laws.first().map_or("", |first| &first.name);
        Some(format!(
            "{} compared with {first}: {judged} ({} mN·m, {} N)",
            law.name,
            signed(torque),
            signed(force)
        ))
    }
}

/// Renders the page as HTML.
pub fn compare_page(page: &ComparePage) -> String {
    let (torque, force) = page.goal;
    let drawn = figures_of(page);
    let body = html! {
        (incomplete(page.trials, page.planned, "completed under every law"))
        h1 { "Comparison of control laws: " (page.name) }
        @for law in 1..page.laws.len() {
            @if let Some(verdict) = page.verdict(law) { p.verdict { (verdict) "." } }
        }
        (tiles(&page.laws.iter().filter_map(tile_of).collect::<Vec<_>>()))
        p {
            (page.trials) " trials under each law, with the same random draws. A trial is a success if the cap is tightened to at least "
            (torque) " mN·m and no element force exceeds " (force) " N. Brackets show 95 % confidence intervals: "
            "Wilson intervals for success, percentile bootstrap for all other measures. Differences are paired by trial."
            @if page.trials == 1 { " For a single trial, only success has an interval." }
        }
        p { code { (page.varied) } }
        @if !drawn.is_empty() {
            h2 { "Figures" }
            (figures(&drawn))
        }
        h2 { "Means" }
        (laws_table(page, true, |row| row.value, number))
        h2 { "Differences from " (page.laws.first().map_or("", |law| &law.name)) }
        (laws_table(page, false, |row| row.difference, signed))
        p.note {
            "Bands show 95 % confidence intervals. Final torque, friction and work lost in slip are ground truth of the simulator, which no law uses; "
            "element forces are measured. Path of the fingertip's centre during MOVE in strokes 3 and 4, as in a run's report: variation of its distance "
            "from the cap's axis, and curvature relative to the arc about that axis (1 = follows the arc). "
            "Grip variation is the standard deviation of the grasp force divided by its mean, in the same strokes."
        }
        (folded("Experiment, without law and varied values", &page.experiment))
    };
    let title = format!("Comparison of control laws: {}", page.name);
    document_of_figures(&title, body, &drawn)
}

fn figures_of(page: &ComparePage) -> Vec<Figure> {
    let pairs = page.pairs.iter().zip(1..);
    let mut figures: Vec<_> = pairs.map(|(p, number)| pairs_figure(p, number)).collect();
    let curves = page.curves.iter().zip(figures.len() as u32 + 1..);
    figures.extend(curves.map(|(curves, number)| curves_figure(curves, number)));
    figures
}

/// Key figure of a law: its success rate (first row).
fn tile_of(law: &ComparedLaw) -> Option<Tile> {
    let row = law.rows.first()?;
    let (name, unit) = name_and_unit(row.name);
    let label = format!("{name} of {}", law.name);
    Some(Tile::new(significant(row.value?[1]), unit, label))
}

/// Table with a row per measure, optionally the lines of code, and a column per law.
fn laws_table(
    page: &ComparePage,
    lines: bool,
    which: impl Fn(&Row) -> Option<[f64; 3]>,
    text: impl Fn([f64; 3]) -> String,
) -> Markup {
    let names = page.laws.first().map_or(&[][..], |law| &law.rows);
    let measured = names.iter().enumerate().map(|(index, row)| {
        let values = page.laws.iter().map(|law| {
            let value = law.rows.get(index).and_then(&which);
            value.map_or_else(String::new, &text)
        });
        html! { td { (row.name) } (numbers(values)) }
    });
    let lines = lines.then(|| {
        let lines = page.laws.iter().map(|law| law.lines);
        let lines = lines.map(|lines| lines.map_or("-".into(), |lines| lines.to_string()));
        html! { td { "lines of code of the law" } (numbers(lines)) }
    });
    let laws = page.laws.iter().map(|law| &law.name);
    table(
        html! { th { "" } (number_heads(laws)) },
        measured.chain(lines),
    )
}
