//! Figures of a robustness study: fractions with intervals, a heat map of total-effect indices, and fractions against
//! parameters.

use super::Figure;
use super::sweep::{Varied, parameter_panel, rate_with_band};
use crate::figures::drawing::canvas::{Pen, REFERENCE, WIDTH, finger_colour, line, range, sheet};
use crate::figures::drawing::grid;
use crate::figures::drawing::sheet::tiled;
use crate::measures::claim::DecidedBy;
use maud::{Markup, html};
use serde::Serialize;

/// Name of the share in which only the run's seed varies.
pub const NOTHING: &str = "nothing varied";

/// A claim, or all claims together.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Measure {
    /// Name of the claim or combination.
    pub name: String,
    /// Part of the apparatus (hand, or hand and bottle) on which the result depends; `None` (JSON null) for all claims
    /// together and for tasks other than screwing a cap.
    pub decided_by: Option<DecidedBy>,
    /// Fraction of hands that pass: with everything varied, with each group varied alone, and with only the seed
    /// varied.
    pub shares: Vec<Share>,
    /// Sensitivity of the result (pass or fail) to each factor.
    pub holds: Vec<Index>,
    /// Sensitivity of the margin (-1 to 1) to each factor; empty if the measure has no margin.
    pub margin: Vec<Index>,
    /// Parameters with the largest total effect.
    #[serde(skip)]
    pub traces: Vec<Trace>,
}

/// A fraction of hands.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Share {
    /// Name of the set of hands.
    pub of: String,
    /// Number of hands in the set.
    pub hands: u64,
    /// Number of hands in the set that pass the claim.
    pub holding: u64,
    /// Fraction (0 to 1) with Wilson's 95 % interval: `[low, fraction, high]`.
    pub share: [f64; 3],
}

/// Sobol' sensitivity indices of one factor with their 95 % intervals (`[low, index, high]`); `None` if the measure
/// does not vary.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Index {
    /// Name of the factor.
    pub factor: String,
    /// First-order index: fraction of the variance explained by the factor alone.
    pub first: Option<[f64; 3]>,
    /// Total-effect index: fraction of the variance explained by the factor, interactions included.
    pub total: Option<[f64; 3]>,
}

/// Values of a parameter in all hands, with the claim's result.
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    /// Values and results.
    pub varied: Varied,
    /// Total-effect index of the parameter.
    pub total: f64,
    /// Nominal value in the experiment.
    pub nominal: Option<f64>,
}

impl Measure {
    /// Parameters that influence the result, by decreasing total effect. Excludes those whose interval includes 0.
    pub fn deciding(&self, parameters: usize) -> Vec<(&str, f64)> {
        let alone = self.holds.iter().take(parameters);
        let known = alone.filter_map(|index| Some((index.factor.as_str(), index.total?)));
        let clear = known.filter(|(_, total)| total[0] > 0.0);
        let mut ranked: Vec<_> = clear.map(|(factor, total)| (factor, total[1])).collect();
        ranked.sort_by(|a, b| b.1.total_cmp(&a.1));
        ranked
    }
}

/// Pen of the experiment's nominal value.
const NOMINAL: Pen = Pen::dashed(REFERENCE, 1.2);
/// Row height of a chart.
const ROW: f64 = 17.0;
/// Left end of a chart, to the right of its labels.
const LEFT: f64 = 190.0;
/// Space for the slanted label of the last column, to the right of its cell.
const SLANT: f64 = 44.0;
/// Maximum number of parameters in a heat map; the least influential are omitted.
const MOST: usize = 16;

/// Chart of fractions: for each claim one dot per set of hands, with its interval.
pub fn shares_figure(measures: &[Measure], number: u32) -> Figure {
    let kinds = measures.first().map_or(0, |m| m.shares.len());
    let block = 10.0 * kinds as f64 + 14.0;
    let top = 24.0 * kinds.div_ceil(2) as f64 + 8.0;
    let bottom = top + block * measures.len() as f64;
    let x = |share: f64| LEFT + share * (WIDTH - LEFT - 20.0);
    let legend = measures.first().map_or(&[][..], |m| &m.shares);
    let body = html! {
        @for (kind, share) in legend.iter().enumerate() {
            @let (left, y) = (16.0 + 230.0 * (kind % 2) as f64, 16.0 + 24.0 * (kind / 2) as f64);
            (dot(left + 11.0, y, share, kind))
            line x1=(left) x2=(left + 22.0) y1=(y) y2=(y) stroke=(colour(share, kind)) stroke-width="2" {}
            text x=(left + 30.0) y=(y + 5.0) { (share.of) }
        }
        @for tick in 0..=4 {
            @let share = 0.25 * f64::from(tick);
            line x1=(x(share)) x2=(x(share)) y1=(top) y2=(bottom) stroke="#d9d9d9" stroke-width="0.8" {}
            text x=(x(share)) y=(bottom + 18.0) text-anchor="middle" font-size="13" { (25 * tick) }
        }
        @for (index, measure) in measures.iter().enumerate() {
            @let upper = top + block * index as f64;
            line x1="10" x2=(WIDTH - 20.0) y1=(upper) y2=(upper) stroke="#d9d9d9" stroke-width="0.8" {}
            text x=(LEFT - 10.0) y=(upper + 0.5 * block + 5.0) text-anchor="end" { (measure.name) }
            @for (kind, share) in measure.shares.iter().enumerate() {
                @let y = upper + 12.0 + 10.0 * kind as f64;
                line x1=(x(share.share[0])) x2=(x(share.share[2])) y1=(y) y2=(y) stroke=(colour(share, kind)) stroke-width="2" {}
                (dot(x(share.share[1]), y, share, kind))
            }
        }
        line x1=(LEFT) x2=(x(1.0)) y1=(bottom) y2=(bottom) stroke="black" {}
        text x=(x(0.5)) y=(bottom + 38.0) text-anchor="middle" { "hands that pass (%)" }
    };
    let title = "Fraction of hands that pass each claim";
    let caption = "One dot per set of hands, with Wilson's 95 % interval.";
    let svg = sheet(number, title, bottom + 50.0, body);
    Figure::still(number, title, caption, svg)
}

/// Colour of a set of hands: black if everything varies, gray if nothing varies, and finger colours for groups.
fn colour(share: &Share, kind: usize) -> &'static str {
    match kind {
        0 => "#000000",
        _ if share.of == NOTHING => "#8a8a8a",
        group => finger_colour(group - 1),
    }
}

fn dot(x: f64, y: f64, share: &Share, kind: usize) -> Markup {
    let radius = if kind == 0 { 4.4 } else { 3.4 };
    html! { circle cx=(x) cy=(y) r=(radius) fill=(colour(share, kind)) {} }
}

/// Total-effect indices by factor and claim: parameters by decreasing influence, then the other factors. The first
/// `parameters` factors are parameters.
pub fn indices_figure(
    measures: &[Measure],
    (factor_names, parameters): (&[String], usize),
    (of, caption): (&str, &str),
    which: impl Fn(&Measure) -> &Vec<Index>,
    number: u32,
) -> Figure {
    let measures = measures.iter().filter(|m| !which(m).is_empty());
    let measures: Vec<_> = measures.collect();
    let total = |measure: &Measure, factor: usize| which(measure).get(factor).and_then(|i| i.total);
    // Sum over claims of the indices that are significantly above 0.
    let weight = |factor: usize| -> f64 {
        let totals = measures.iter().filter_map(|m| total(m, factor));
        totals.filter(|t| t[0] > 0.0).map(|t| t[1]).sum()
    };
    let mut factors: Vec<usize> = (0..parameters).collect();
    factors.sort_by(|&a, &b| weight(b).total_cmp(&weight(a)));
    let left_out = factors.len().saturating_sub(MOST);
    factors.truncate(MOST);
    factors.extend(parameters..factor_names.len());
    let cell = (WIDTH - LEFT - SLANT) / measures.len().max(1) as f64;
    let top = 128.0;
    // Factors that are not parameters are set apart.
    let y = |row: usize| {
        top + ROW * row as f64
            + if row >= factors.len() - (factor_names.len() - parameters) {
                8.0
            } else {
                0.0
            }
    };
    let bottom = y(factors.len());
    let note = format!("and {left_out} less influential ones");
    let body = html! {
        @for (column, measure) in measures.iter().enumerate() {
            @let x = LEFT + cell * (column as f64 + 0.5);
            text x=(x) y=(top - 8.0) font-size="12" transform=(format!("rotate(-45 {x} {})", top - 8.0)) { (measure.name) }
        }
        @for (row, &factor) in factors.iter().enumerate() {
            text x=(LEFT - 8.0) y=(y(row) + 13.0) text-anchor="end" font-size="12.5" { (factor_names[factor]) }
            @for (column, measure) in measures.iter().enumerate() {
                (cell_of(total(measure, factor), LEFT + cell * column as f64, y(row), cell))
            }
        }
        @if left_out > 0 { text x=(LEFT) y=(bottom + 16.0) font-size="12" fill="#555" { (note) } }
    };
    let title = format!("Total-effect indices of the {of}");
    let svg = sheet(number, &title, bottom + 26.0, body);
    Figure::still(number, title, caption, svg)
}

/// One index in percent, on a background from white (0) to blue (1); pale on white if not significantly above 0.
fn cell_of(total: Option<[f64; 3]>, x: f64, y: f64, width: f64) -> Markup {
    let clear = total.filter(|[low, ..]| *low > 0.0);
    let shown = clear.map_or(0.0, |t| t[1]).clamp(0.0, 1.0);
    // The square root makes small values distinguishable.
    let depth = shown.sqrt();
    let mix = |from: f64, to: f64| (from + (to - from) * depth).round() as u8;
    let fill = format!(
        "#{:02x}{:02x}{:02x}",
        mix(255.0, 0.0),
        mix(255.0, 88.0),
        mix(255.0, 152.0)
    );
    let ink = match clear {
        None => "#888",
        Some(_) if depth > 0.6 => "white",
        Some(_) => "black",
    };
    html! {
        rect x=(x) y=(y) width=(width - 1.0) height=(ROW - 1.0) fill=(fill) {}
        text x=(x + 0.5 * width) y=(y + 12.5) text-anchor="middle" font-size="11" fill=(ink) {
            @match total { Some(total) => { (format!("{:.0}", 100.0 * total[1].max(0.0))) } None => { "–" } }
        }
    }
}

/// Fraction of hands that pass a claim against the most influential parameters, one panel each.
pub fn traces_figure(measure: &Measure, number: u32) -> Figure {
    let title = format!("{}: most influential parameters", measure.name);
    let panels = measure.traces.iter().map(trace).collect();
    let legend = [
        (measure.name.as_str(), Pen::solid(finger_colour(0), 2.0)),
        ("nominal value", NOMINAL),
    ];
    let drawing = tiled((number, &title), &legend, panels, 1, 170.0);
    let caption = "Fraction of hands in bins of equal width, with all other parameters varied as well, and Wilson's 95 % interval.";
    Figure::drawn(number, title, caption, Some(drawing))
}

fn trace(trace: &Trace) -> grid::Panel {
    let mut plots = rate_with_band(&trace.varied, Pen::solid(finger_colour(0), 2.0));
    let (low, high) = range(trace.varied.trials.iter().map(|t| t.0)).unwrap_or((0.0, 1.0));
    let inside = trace.nominal.filter(|n| (low..=high).contains(n));
    plots.extend(inside.map(|nominal| line([(nominal, 0.0), (nominal, 100.0)], NOMINAL)));
    let total = 100.0 * trace.total;
    let label = format!("{}, total effect {total:.0} %", trace.varied.name);
    let layout = parameter_panel(&trace.varied, &label, (0.0, 100.0), "passes (%)");
    (plots, layout.with_ticks(4))
}
