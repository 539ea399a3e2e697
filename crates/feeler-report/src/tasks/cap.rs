//! The report of a cap that was screwed until the hand knew what became of it, in place of the paper's claims.

use super::screw::ScrewReport;
use super::{TaskReport, shown};
use crate::cap::{CapMeasures, DAMAGE_TIME, FeltStroke, TIGHT};
use crate::claim::Claim;
use crate::figures::{Figure, cap};
use crate::run_data::RunData;
use crate::strokes::StrokeMeasures;
use crate::summary::Summary;
use crate::text::{significant, value};
use feeler_record::{Recording, TaskOutcome};
use maud::{Markup, html};

/// The report of a cap that was closed or opened by touch.
pub struct CapReport;

impl TaskReport for CapReport {
    fn whose(&self) -> &'static str {
        "of this task"
    }

    /// None: the hand's own word is held against the instruments.
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

/// One column: name with unit, and the value in that unit.
type Column = (&'static str, fn(&FeltStroke) -> Option<f64>);

const COLUMNS: [Column; 4] = [
    ("Turn felt (°)", |s| s.felt_turn.map(f64::to_degrees)),
    ("Turn (°)", |s| s.turn.map(f64::to_degrees)),
    ("Largest torque felt (mN·m)", |s| {
        s.felt_torque.map(|t| 1e3 * t)
    }),
    ("Largest torque by the sensor (mN·m)", |s| {
        s.torque.map(|t| 1e3 * t)
    }),
];

/// What became of the cap, and the strokes as they were felt.
fn cap_section(summary: &Summary, cap: &CapMeasures) -> Markup {
    let outcome = summary
        .outcome
        .as_ref()
        .map_or("nothing that it could tell", TaskOutcome::as_str);
    html! {
        h2 { "What became of the cap" }
        p.verdict {
            "The hand's own word: " b { (outcome) } ". It was told nothing of torque or angle; both columns “felt” below are made "
            "of forces on its fingertips and its encoders."
        }
        @let (strokes, left_out) = shown(&cap.strokes);
        @let columns: Vec<_> = COLUMNS.iter().filter(|column| cap.strokes.iter().any(|stroke| column.1(stroke).is_some())).collect();
        table {
            tbody {
                @for (name, value) in rows(cap) { tr { th scope="row" { (name) } td { (value) } } }
            }
        }
        h2 { "Strokes" }
        div.scroll {
            table {
                thead { tr { th { "Stroke" } @for (name, _) in &columns { th.number { (name) } } } }
                tbody {
                    @for stroke in &strokes {
                        tr {
                            td { (stroke.index) }
                            @for (_, measure) in &columns { td.number { (value(measure(stroke))) } }
                        }
                    }
                }
            }
        }
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
            "What friction allows: static coefficient × grip allowed × radius × fingers"
                .to_string(),
            cap.friction_limit
                .map_or_else(|| "unknown".to_string(), |limit| milli(Some(limit))),
        ),
        (
            "Largest torque, by the sensor".to_string(),
            milli(cap.largest_torque),
        ),
    ];
    if let (Some(1.0), Some(ratio)) = (cap.sense, cap.torque_ratio) {
        let tight = significant(1e2 * TIGHT);
        rows.push((
            format!("Largest torque of the last stroke, by the sensor; a closed cap is tight from {tight} % of what friction allows"),
            format!("{}, {} %", milli(cap.final_torque), significant(1e2 * ratio)),
        ));
    }
    rows.push((
        format!(
            "Longest time of an element over its damage limit ({} ms are borne)",
            significant(1e3 * DAMAGE_TIME)
        ),
        (cap.time_over_damage).map_or_else(not_measured, |time| {
            format!("{} ms", significant(1e3 * time))
        }),
    ));
    rows
}
