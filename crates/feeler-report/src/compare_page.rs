//! `compare.html`: control laws on the same trials, on one self-contained page.

use super::document::{Tile, document, tiles};
use super::figures::Figure;
use super::figures::compare::{curves_figure, pairs_figure};
use super::page_data::PageData;
use super::text::{name_and_unit, significant};
use maud::{Markup, html};

/// What the page shows.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ComparePage {
    /// The experiment's name.
    pub name: String,
    /// Trials that every law finished.
    pub trials: u64,
    /// Trials that were asked for.
    pub planned: u64,
    /// Torque to reach, mN·m, and force not to exceed, N, for a success.
    pub goal: (f64, f64),
    /// The laws; the others are compared with the first.
    pub laws: Vec<ComparedLaw>,
    /// Success and measures against what varies.
    pub curves: Vec<Curves>,
    /// Every other law beside the first, trial by trial.
    pub pairs: Vec<Pairs>,
    /// Seed and expressions, as on the command line.
    pub varied: String,
    /// The experiment, but for law and what varied.
    pub experiment: String,
}

/// One law.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedLaw {
    /// Its name.
    pub name: String,
    /// Lines of its code, without blank ones and comments; none of a policy, which is numbers.
    pub lines: Option<usize>,
    /// The same for all laws.
    pub rows: Vec<Row>,
}

/// One measure of a law: its mean, and the mean of its difference from the first law's in the same trial. Each
/// stands between the ends of its 95 % confidence interval, which are not numbers where one trial has no interval.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// What it is, with its unit.
    pub name: &'static str,
    /// The mean.
    pub value: Option<[f64; 3]>,
    /// The difference.
    pub difference: Option<[f64; 3]>,
}

/// A measure of all laws against what varies.
#[derive(Debug, Clone, PartialEq)]
pub struct Curves {
    /// The measure, with its unit.
    pub title: String,
    /// What varies.
    pub against: String,
    /// A curve for each law.
    pub curves: Vec<Curve>,
}

/// Two laws on the same trials.
#[derive(Debug, Clone, PartialEq)]
pub struct Pairs {
    /// The first law.
    pub first: String,
    /// The other one.
    pub other: String,
    /// What is measured.
    pub measures: Vec<PairedMeasure>,
}

/// A measure of two laws.
#[derive(Debug, Clone, PartialEq)]
pub struct PairedMeasure {
    /// What it is, with its unit.
    pub name: &'static str,
    /// Of each trial that has it under both laws: its number, the first law's value, the other's.
    pub trials: Vec<(u64, f64, f64)>,
}

/// A measure of one law against what varies.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// The law.
    pub law: String,
    /// What varies, and the mean between the ends of its 95 % confidence interval.
    pub points: Vec<(f64, [f64; 3])>,
}

impl ComparePage {
    /// How a law compares with the first in torque and peak force, in a sentence; none for the first.
    pub fn verdict(&self, law: usize) -> Option<String> {
        let law = self.laws.get(law).filter(|_| law > 0)?;
        let [torque, force] = [law.rows.get(1)?, law.rows.get(2)?].map(|row| row.difference);
        let (torque, force) = (torque?, force?);
        let judged = match (torque[0] > 0.0, force[2] < 0.0) {
            (true, true) => "more torque at less force",
            (true, false) if force[0] > 0.0 => "more torque, at more force",
            (true, false) => "more torque at about the same force",
            (false, true) if torque[2] < 0.0 => "less force, at less torque",
            (false, true) => "less force at about the same torque",
            (false, false) if torque[0].is_nan() => "not to be judged by one trial",
            (false, false) => "better in neither",
        };
        let first = self.laws.first().map_or("", |first| &first.name);
        Some(format!(
            "{} against {first}: {judged} ({} mN·m, {} N)",
            law.name,
            signed(torque),
            signed(force)
        ))
    }
}

/// The page, as HTML text.
pub fn compare_page(page: &ComparePage) -> String {
    let (torque, force) = page.goal;
    let figures = figures_of(page);
    let body = html! {
        @if page.trials < page.planned {
            div.incomplete role="alert" {
                "INCOMPLETE: " (page.trials) " of " (page.planned) " trials are finished under every law."
            }
        }
        h1 { "Control laws compared: " (page.name) }
        @for law in 1..page.laws.len() {
            @if let Some(verdict) = page.verdict(law) { p.verdict { (verdict) "." } }
        }
        (tiles(&page.laws.iter().filter_map(tile_of).collect::<Vec<_>>()))
        p {
            (page.trials) " trials under each law, with the same draws. A success is a cap that was tightened to "
            (torque) " mN·m or more with no element above " (force) " N. In brackets 95 % confidence: "
            "Wilson's interval for success, the percentile bootstrap for all else; differences are taken trial by trial."
            @if page.trials == 1 { " One trial has no interval but that of success." }
        }
        p { code { (page.varied) } }
        @if !figures.is_empty() {
            h2 { "Figures" }
            div.figures { @for figure in &figures { (figure.markup()) } }
        }
        h2 { "Means" }
        (table(page, true, |row| row.value, number))
        h2 { "Differences from " (page.laws.first().map_or("", |law| &law.name)) }
        (table(page, false, |row| row.difference, signed))
        p.note {
            "Bands are 95 % confidence. Final torque, friction and work lost in slip are the simulator's truth, which no law sees; "
            "element forces are as felt. The path of the fingertip's centre in MOVE, as in a run's report, in strokes 3 and 4: how far its distance "
            "to the cap's axis varies, and how much it bends relative to the arc about that axis (1 = follows it). "
            "Grip variation is the standard deviation of the grasp force over its mean, in the same strokes."
        }
        details {
            summary { "The experiment, but for law and what varied" }
            pre { (page.experiment) }
        }
    };
    let title = format!("Control laws compared: {}", page.name);
    document(&title, body, &PageData::of_figures(&title, &figures))
}

fn figures_of(page: &ComparePage) -> Vec<Figure> {
    let pairs = page.pairs.iter().zip(1..);
    let mut figures: Vec<_> = pairs.map(|(p, number)| pairs_figure(p, number)).collect();
    let curves = page.curves.iter().zip(figures.len() as u32 + 1..);
    figures.extend(curves.map(|(curves, number)| curves_figure(curves, number)));
    figures
}

/// The first row of a law: its success.
fn tile_of(law: &ComparedLaw) -> Option<Tile> {
    let row = law.rows.first()?;
    let (name, unit) = name_and_unit(row.name);
    let label = format!("{name} of {}", law.name);
    Some(Tile::new(significant(row.value?[1]), unit, label))
}

/// A row for each measure, and for the lines of code where wanted; a column for each law.
fn table(
    page: &ComparePage,
    lines: bool,
    which: impl Fn(&Row) -> Option<[f64; 3]>,
    text: impl Fn([f64; 3]) -> String,
) -> Markup {
    let names = page.laws.first().map_or(&[][..], |law| &law.rows);
    html! {
        div.scroll {
            table {
                thead { tr { th { "" } @for law in &page.laws { th.number { (law.name) } } } }
                tbody {
                    @for (index, row) in names.iter().enumerate() {
                        tr {
                            td { (row.name) }
                            @for law in &page.laws {
                                td.number { (law.rows.get(index).and_then(&which).map_or_else(String::new, &text)) }
                            }
                        }
                    }
                    @if lines {
                        tr {
                            td { "lines of code of the law" }
                            @for law in &page.laws { td.number { (law.lines.map_or("-".into(), |lines| lines.to_string())) } }
                        }
                    }
                }
            }
        }
    }
}

/// What stands for the interval of a single trial.
const NO_INTERVAL: &str = "(no interval)";

/// A mean and its interval.
pub fn number([low, mean, high]: [f64; 3]) -> String {
    let digits = digits(mean);
    if low.is_nan() || high.is_nan() {
        return format!("{mean:.digits$} {NO_INTERVAL}");
    }
    format!("{mean:.digits$} [{low:.digits$}, {high:.digits$}]")
}

/// A difference and its interval.
pub fn signed([low, mean, high]: [f64; 3]) -> String {
    let digits = digits(mean);
    if low.is_nan() || high.is_nan() {
        return format!("{mean:+.digits$} {NO_INTERVAL}");
    }
    format!("{mean:+.digits$} [{low:+.digits$}, {high:+.digits$}]")
}

fn digits(value: f64) -> usize {
    if value.abs() < 10.0 { 2 } else { 1 }
}
