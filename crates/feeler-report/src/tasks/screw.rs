//! Report of the screw task: the paper's claims and figures, and a table of strokes.

use super::task_report::{TaskReport, shown};
use crate::claims::claims;
use crate::figures::{Figure, paths, radius, time};
use crate::measures::claim::Claim;
use crate::measures::strokes::StrokeMeasures;
use crate::measures::summary::Summary;
use crate::pages::document::{number_heads, numbers, table};
use crate::pages::text::{significant, value};
use crate::run::data::RunData;
use feeler_record::{Phase, Recording};
use maud::{Markup, html};

/// Report of the screw task.
pub struct ScrewReport;

impl TaskReport for ScrewReport {
    fn whose(&self) -> &'static str {
        "of the paper"
    }

    fn claims(&self, _: &Recording, data: &RunData, strokes: &[StrokeMeasures]) -> Vec<Claim> {
        claims(data, strokes)
    }

    fn figures(&self, _: &Recording, data: &RunData) -> Vec<Figure> {
        vec![
            time::grasp_force_and_torque(data),
            time::shear_rate_and_torque(data),
            time::stroke_in_detail(data, 10, 1),
            time::stroke_in_detail(data, 11, 4),
            paths::before_closing(data),
            paths::after_closing(data),
            radius::over_travel(data),
        ]
    }

    fn verdict(&self, recording: &Recording, summary: &Summary) -> Markup {
        let peak = (summary.strokes.iter())
            .filter_map(|stroke| stroke.peak_torque)
            .reduce(f64::max);
        html! {
            "In " (significant(summary.sim_time)) " s the hand made " (strokes_made(recording)) " of "
            (recording.facts.stroke_count) " strokes"
            @if let Some(angle) = summary.cap_angle {
                ", turned the cap by " (significant(angle.to_degrees())) "°"
            }
            @if let Some(peak) = peak {
                " and reached " (significant(1e3 * peak)) " mN·m of torque"
            }
            "."
            @if let Some(outcome) = &summary.outcome { " Outcome: " b { (outcome) } "." }
        }
    }

    fn measured(&self, _: &Recording, summary: &Summary) -> Markup {
        html! {
            h2 { "Strokes" }
            (strokes_table(&summary.strokes))
        }
    }
}

/// Number of completed strokes (SEARCH to RETURN).
fn strokes_made(recording: &Recording) -> u32 {
    recording.task.last().map_or(0, |task| match task.phase {
        Phase::Done => task.stroke,
        _ => task.stroke.saturating_sub(1),
    })
}

/// Column of the table of strokes: name, unit, and the measure in that unit.
type Column = (
    &'static str,
    &'static str,
    fn(&StrokeMeasures) -> Option<f64>,
);

const STROKE_COLUMNS: [Column; 15] = [
    ("Peak torque", "mN·m", |s| s.peak_torque.map(|v| 1e3 * v)),
    ("Mean grasp force", "N", |s| s.mean_grasp_force),
    ("Peak grasp force", "N", |s| s.peak_grasp_force),
    ("Cap rotation", "°", |s| s.cap_turn.map(f64::to_degrees)),
    ("Peak shear rate", "N/s", |s| s.peak_shear_rate),
    ("SLIP", "% of MOVE", |s| s.slip_fraction.map(|v| 1e2 * v)),
    ("Precision of SLIP", "%", |s| {
        s.slip_precision.map(|v| 1e2 * v)
    }),
    ("True slip", "% of MOVE", |s| {
        s.true_slip_fraction.map(|v| 1e2 * v)
    }),
    ("OVER", "% of window", |s| s.over_fraction.map(|v| 1e2 * v)),
    ("Variation of grasp force", "%", |s| {
        s.grasp_force_variation.map(|v| 1e2 * v)
    }),
    ("Inward bend", "mm", |s| s.path_inward_bend.map(|v| 1e3 * v)),
    ("Std of R, distance from the axis", "mm", |s| {
        s.path_radius_std.map(|v| 1e3 * v)
    }),
    ("Std of R on the planned line", "mm", |s| {
        s.line_radius_std.map(|v| 1e3 * v)
    }),
    ("Curvature relative to the arc", "", |s| s.path_curvature),
    ("Peak element force", "N", |s| s.peak_element_force),
];

/// Table with one row per measure and one column per stroke; four strokes fit on a phone. Unmeasured quantities are
/// listed below.
fn strokes_table(strokes: &[StrokeMeasures]) -> Markup {
    let measured = |column: &Column| strokes.iter().any(|stroke| column.2(stroke).is_some());
    let (columns, missing): (Vec<&Column>, Vec<&Column>) =
        STROKE_COLUMNS.iter().partition(|c| measured(c));
    let missing: Vec<_> = missing.iter().map(|column| column.0).collect();
    let (strokes, left_out) = shown(strokes);
    let head = html! { th { "Stroke" } (number_heads(strokes.iter().map(|stroke| stroke.index))) };
    let rows = columns.into_iter().map(|(name, unit, measure)| {
        html! {
            td { (name) @if !unit.is_empty() { " " span.unit { "(" (unit) ")" } } }
            (numbers(strokes.iter().map(|stroke| value(measure(stroke)))))
        }
    });
    html! {
        (table(head, rows))
        (left_out)
        @if !missing.is_empty() { p.note { "Not measured: " (missing.join("; ")) "." } }
    }
}
