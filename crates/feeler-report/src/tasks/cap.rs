//! Report of closing or opening a cap by touch. It replaces the paper's claims.

use super::screw::ScrewReport;
use super::task_report::{TaskReport, shown};
use crate::figures::{Figure, cap};
use crate::measures::cap::{CapMeasures, TIGHT};
use crate::measures::claim::Claim;
use crate::measures::overload::DAMAGE_TIME;
use crate::measures::strokes::{FeltStroke, StrokeMeasures};
use crate::measures::summary::Summary;
use crate::pages::document::{facts_table, number_heads, numbers, table};
use crate::pages::text::{significant, value};
use crate::run::data::RunData;
use feeler_record::{Recording, TaskOutcome};
use maud::{Markup, html};

/// Report of a cap that was closed or opened by touch.
pub struct CapReport;

impl TaskReport for CapReport {
    /// Always empty: the report compares the hand's estimates with the instruments.
    fn claims(&self, _: &Recording, _: &RunData, _: &[StrokeMeasures]) -> Vec<Claim> {
        Vec::new()
    }

    fn figures(&self, recording: &Recording, data: &RunData) -> Vec<Figure> {
        let measured = CapMeasures::new(recording, data);
        measured.map_or_else(Vec::new, |measured| {
            cap::figures(recording, data, &measured)
        })
    }

    fn verdict(&self, recording: &Recording, summary: &Summary) -> Markup {
        ScrewReport.verdict(recording, summary)
    }

    fn measured(&self, _: &Recording, summary: &Summary) -> Markup {
        html! {
            @if let Some(cap) = &summary.cap { (cap_section(summary, cap)) }
        }
    }
}

/// Table column: name with unit, and the value in that unit.
type Column = (&'static str, fn(&FeltStroke) -> Option<f64>);

const COLUMNS: [Column; 4] = [
    ("Estimated rotation (°)", |s| {
        s.felt_turn.map(f64::to_degrees)
    }),
    ("True rotation (°)", |s| s.turn.map(f64::to_degrees)),
    ("Peak torque, estimated (mN·m)", |s| {
        s.felt_torque.map(|t| 1e3 * t)
    }),
    ("Peak torque, measured (mN·m)", |s| {
        s.torque.map(|t| 1e3 * t)
    }),
];

/// Section with the outcome, and the table of strokes.
fn cap_section(summary: &Summary, cap: &CapMeasures) -> Markup {
    let outcome = summary
        .outcome
        .as_ref()
        .map_or("undetermined", TaskOutcome::as_str);
    let (strokes, left_out) = shown(&cap.strokes);
    let measured = |column: &&Column| cap.strokes.iter().any(|stroke| column.1(stroke).is_some());
    let columns: Vec<_> = COLUMNS.iter().filter(measured).collect();
    let head = html! { th { "Stroke" } (number_heads(columns.iter().map(|(name, _)| name))) };
    let values = strokes.iter().map(|stroke| {
        let values = columns.iter().map(|(_, measure)| value(measure(stroke)));
        html! { td { (stroke.index) } (numbers(values)) }
    });
    html! {
        h2 { "Result" }
        p.verdict {
            "Outcome reported by the hand: " b { (outcome) } ". The hand does not measure torque or cap angle; the estimates below are "
            "computed from fingertip forces and joint encoders."
        }
        (facts_table(rows(cap)))
        h2 { "Strokes" }
        (table(head, values))
        (left_out)
    }
}

fn rows(cap: &CapMeasures) -> Vec<(String, String)> {
    let not_measured = || "not measured".to_string();
    let milli = |torque: Option<f64>| {
        torque.map_or_else(not_measured, |t| format!("{} mN·m", significant(1e3 * t)))
    };
    let mut rows = vec![
        (
            "Torque limit of friction: static coefficient × allowed grasp force × radius × fingers"
                .to_string(),
            cap.friction_limit
                .map_or_else(|| "unknown".to_string(), |limit| milli(Some(limit))),
        ),
        (
            "Peak torque, measured".to_string(),
            milli(cap.largest_torque),
        ),
    ];
    if let (Some(1.0), Some(ratio)) = (cap.sense, cap.torque_ratio) {
        let tight = significant(1e2 * TIGHT);
        rows.push((
            format!("Peak torque of the last stroke, measured; a closed cap is tight from {tight} % of the torque limit of friction"),
            format!("{}, {} %", milli(cap.final_torque), significant(1e2 * ratio)),
        ));
    }
    rows.push((
        format!(
            "Longest time of an element above its damage limit ({} ms allowed)",
            significant(1e3 * DAMAGE_TIME)
        ),
        (cap.time_over_damage).map_or_else(not_measured, |time| {
            format!("{} ms", significant(1e3 * time))
        }),
    ));
    rows
}
