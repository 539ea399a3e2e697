//! Claims table of a run report.

use super::text::{significant, value};
use crate::measures::claim::{Claim, ClaimPart, DecidedBy, Relation, Verdict};
use crate::run::data::RunData;
use maud::{Markup, html};

/// Table of claims and their parts. Claims that depend on more than the hand are grouped separately.
pub(crate) fn claims_table(claims: &[Claim], data: &RunData) -> Markup {
    let needs_bottle = |claim: &&Claim| claim.decided_by == Some(DecidedBy::HandAndBottle);
    let (with_bottle, hand): (Vec<_>, Vec<_>) = claims.iter().partition(needs_bottle);
    let grouped = !with_bottle.is_empty();
    html! {
        div.scroll {
            table {
                thead { tr { th { "Claim" } th.number { "Value" } th.number { "Bound" } th { "Result" } } }
                @if grouped { (group("Hand", &hand)) }
                @for claim in &hand { (claim_rows(claim, data)) }
                @if grouped { (group("Hand, bottle and torque sensor", &with_bottle)) }
                @for claim in &with_bottle { (claim_rows(claim, data)) }
            }
        }
    }
}

/// Heading of a group with the number of claims that pass.
fn group(name: &str, claims: &[&Claim]) -> Markup {
    let held = claims.iter().filter(|claim| claim.holds).count();
    html! {
        tbody { tr { th colspan="4" scope="rowgroup" { (name) ": " (held) " of " (claims.len()) " pass" } } }
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

/// Time that a claim's row links to (s): the start of MOVE in the stroke that the claim refers to.
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
        Relation::Equals => "=",
        Relation::Within => "±",
    };
    html! {
        tr {
            td.part { (part.name) }
            td.number { (value(part.value)) " " span.unit { (part.unit) } }
            td.number { (sign) " " (significant(part.bound)) " " span.unit { (part.unit) } }
            // Parts that hold are covered by the claim's result.
            td { @if !part.holds { (holds(part.verdict())) } }
        }
    }
}

fn holds(verdict: Verdict) -> Markup {
    html! {
        @match verdict {
            Verdict::Holds => span.holds { "✓ pass" },
            Verdict::Fails => span.fails { "✗ fail" },
            Verdict::NotMeasured => span.unit { "not measured" },
        }
    }
}
