//! Figure of control laws on the same hands: one bar per law and claim.

use super::Figure;
use super::robustness::Share;
use crate::figures::drawing::canvas::{WIDTH, finger_colour, sheet};
use maud::html;
use serde::Serialize;

/// Results of one law.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LawShares {
    /// Name of the law.
    pub law: String,
    /// Number of hands that are invalid under this law only. No claim passes on them.
    pub refused: u64,
    /// Fraction of hands that pass each claim about any hand, and that pass all of these claims and complete the task.
    pub shares: Vec<Share>,
}

/// Height of a 100 % bar.
const HEIGHT: f64 = 220.0;
/// Left end of the axis.
const LEFT: f64 = 44.0;
/// Number of laws per legend line.
const PER_LINE: usize = 2;

/// One group of bars per claim, one bar per law, with Wilson's interval.
pub fn law_shares_figure(laws: &[LawShares], number: u32) -> Figure {
    let of = laws.first().map_or(&[][..], |law| &law.shares);
    let top = 24.0 * laws.len().div_ceil(PER_LINE) as f64 + 14.0;
    let group = (WIDTH - LEFT - 16.0) / of.len().max(1) as f64;
    let bar = (group - 14.0) / laws.len().max(1) as f64;
    let y = |share: f64| top + HEIGHT * (1.0 - share);
    let body = html! {
        @for (index, law) in laws.iter().enumerate() {
            @let (x, y) = (LEFT + 210.0 * (index % PER_LINE) as f64, 8.0 + 24.0 * (index / PER_LINE) as f64);
            rect x=(x) y=(y) width="14" height="14" fill=(finger_colour(index)) {}
            text x=(x + 20.0) y=(y + 12.0) font-size="13" { (law.law) }
        }
        @for tick in 0..=4 {
            @let share = 0.25 * f64::from(tick);
            line x1=(LEFT) x2=(WIDTH - 16.0) y1=(y(share)) y2=(y(share)) stroke="#d9d9d9" stroke-width="0.8" {}
            text x=(LEFT - 6.0) y=(y(share) + 4.0) text-anchor="end" font-size="13" { (25 * tick) }
        }
        @for (column, share) in of.iter().enumerate() {
            @let middle = LEFT + group * (column as f64 + 0.5);
            // Two lines, so that adjacent labels do not overlap.
            @let (first, last) = share.of.rsplit_once(' ').unwrap_or((&share.of, ""));
            text x=(middle) y=(y(0.0) + 16.0) text-anchor="middle" font-size="12" { (first) }
            text x=(middle) y=(y(0.0) + 30.0) text-anchor="middle" font-size="12" { (last) }
        }
        @for (row, law) in laws.iter().enumerate() {
            @for (column, share) in law.shares.iter().enumerate() {
                @let x = LEFT + group * column as f64 + 7.0 + bar * row as f64;
                @let [low, middle, high] = share.share;
                rect x=(x) y=(y(middle)) width=(bar - 1.0) height=(HEIGHT * middle) fill=(finger_colour(row)) {}
                line x1=(x + 0.5 * bar) x2=(x + 0.5 * bar) y1=(y(low)) y2=(y(high)) stroke="black" stroke-width="1.2" {}
            }
        }
        line x1=(LEFT) x2=(WIDTH - 16.0) y1=(y(0.0)) y2=(y(0.0)) stroke="black" {}
    };
    let title = "Fraction of hands that pass each claim of any hand (%)";
    let caption = "One bar per law, with Wilson's 95 % interval. All laws ran on the same hands.";
    let svg = sheet(number, title, y(0.0) + 42.0, body);
    Figure::still(number, title, caption, svg)
}
