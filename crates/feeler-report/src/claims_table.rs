//! The table of a run's claims on its page.

use super::claim::{Claim, ClaimPart, DecidedBy, Relation, Verdict};
use super::run_data::RunData;
use super::text::{significant, value};
use maud::{Markup, html};

/// A row for each claim and each of its parts. Claims that need more than the hand are in a group of their own.
pub(crate) fn claims_table(claims: &[Claim], data: &RunData) -> Markup {
    let needs_bottle = |claim: &&Claim| claim.decided_by == Some(DecidedBy::HandAndBottle);
    let (with_bottle, hand): (Vec<_>, Vec<_>) = claims.iter().partition(needs_bottle);
    let grouped = !with_bottle.is_empty();
    html! {
        div.scroll {
            table {
                thead { tr { th { "Claim" } th.number { "Value" } th.number { "Bound" } th { "Holds" } } }
                @if grouped { (group("About the hand", &hand)) }
                @for claim in &hand { (claim_rows(claim, data)) }
                @if grouped { (group("About the hand, the paper's bottle and the torque sensor", &with_bottle)) }
                @for claim in &with_bottle { (claim_rows(claim, data)) }
            }
        }
    }
}

/// The heading of a group, with how many of its claims hold.
fn group(name: &str, claims: &[&Claim]) -> Markup {
    let held = claims.iter().filter(|claim| claim.holds).count();
    html! {
        tbody { tr { th colspan="4" scope="rowgroup" { (name) ": " (held) " of " (claims.len()) " hold" } } }
    }
}

fn claim_rows(claim: &Claim, data: &RunData) -> Markup {
    html! {
        tbody.claim data-time=[moment(claim, data)] {
            tr {
                td colspan="3" { (claim.text) " " span.unit { (claim.id) } }
                td { (holds(claim.verdict)) }
            }
            @for part in &claim.parts { (part_row(part)) }
        }
    }
}

/// When a claim's moment is, s: the beginning of MOVE in the stroke that it is about.
fn moment(claim: &Claim, data: &RunData) -> Option<f64> {
    let mut moved = data
        .strokes
        .iter()
        .filter(|stroke| !stroke.moving.is_empty());
    let stroke = match claim.id {
        "four-peaks" | "first-stroke-torque-rises" => moved.next(),
        "no-damage" | "hand-overloads-nothing" => None,
        _ => moved.next_back(),
    }?;
    data.time.get(stroke.moving.start).copied()
}

fn part_row(part: &ClaimPart) -> Markup {
    let sign = match part.relation {
        Relation::AtLeast => "≥",
        Relation::AtMost => "≤",
        Relation::Below => "<",
        Relation::Equals => "=",
        Relation::Within => "±",
    };
    html! {
        tr {
            td.part { (part.name) }
            td.number { (value(part.value)) " " span.unit { (part.unit) } }
            td.number { (sign) " " (significant(part.bound)) " " span.unit { (part.unit) } }
            // The claim's own mark covers the parts that hold.
            td { @if !part.holds { (holds(part.verdict())) } }
        }
    }
}

fn holds(verdict: Verdict) -> Markup {
    html! {
        @match verdict {
            Verdict::Holds => span.holds { "✓ yes" },
            Verdict::Fails => span.fails { "✗ no" },
            Verdict::NotMeasured => span.unit { "not measured" },
        }
    }
}
