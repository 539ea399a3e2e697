//! `report.html`: one self-contained page for phone, desk and print.

use super::cap_section::cap_section;
use super::claim::{Claim, ClaimPart, Relation};
use super::figures::Figure;
use super::strokes::StrokeMeasures;
use super::summary::Summary;
use crate::record::{Phase, Recording, RunFacts};
use maud::{DOCTYPE, Markup, PreEscaped, html};

const STYLE: &str = include_str!("page.css");

/// The page, as HTML text.
pub fn page(recording: &Recording, summary: &Summary, figures: &[Figure]) -> String {
    let facts = &recording.facts;
    let name = format!("{}, seed {}", facts.experiment, facts.seed);
    let mark = if recording.complete {
        ""
    } else {
        "INCOMPLETE: "
    };
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (mark) (name) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                (banner(recording))
                h1 { "Run report: " (name) }
                @if let Some(original) = &facts.replay_of {
                    p.note {
                        "A replay. Joint angles, torque and cap are those on record and did not follow from the "
                        "commands here. Replayed was the recording with digest " span.digest { (original) } "."
                    }
                }
                p.verdict { (verdict(recording, summary)) }
                @if let Some(cap) = &summary.cap {
                    (cap_section(summary, cap))
                } @else {
                    h2 { "The paper's claims" }
                    (claims_table(&summary.claims))
                    h2 { "Strokes" }
                    (strokes_table(&summary.strokes))
                }
                h2 { "Figures" }
                div.figures { @for figure in figures { (figure_markup(figure)) } }
                h2 { "The run" }
                (facts_table(facts, summary))
                details {
                    summary { "The experiment as run (" code { "experiment.toml" } ")" }
                    pre { (recording.experiment) }
                }
                p { "Digest of the recording's content (SHA-256):" br; span.digest { (summary.digest) } }
                p.note {
                    "Claims and figures refer to M. Ohka, N. Morisawa and H. B. Yussof, “Trajectory "
                    "Generation of Robotic Fingers Based on Tri-axial Tactile Data for Cap Screwing "
                    "Task”, 2009. Everything on this page is computed from the recording."
                }
            }
        }
    }
    .into_string()
}

/// The unmistakable sign over a report of a damaged recording.
fn banner(recording: &Recording) -> Markup {
    html! {
        @if let Some(problem) = &recording.problem {
            div.incomplete role="alert" {
                "INCOMPLETE: readable up to t = " (format!("{:.2}", recording.readable_until)) " s. "
                "The recording is damaged or the run was interrupted (" (problem) "). "
                "Numbers and figures below are of what is readable only."
            }
        }
    }
}

/// The run in one paragraph.
fn verdict(recording: &Recording, summary: &Summary) -> Markup {
    let total = summary.claims.len();
    let held = summary.claims.iter().filter(|claim| claim.holds).count();
    let ids = |wanted: fn(&Claim) -> bool| {
        let claims = summary.claims.iter().filter(|claim| wanted(claim));
        claims.map(|claim| claim.id).collect::<Vec<_>>().join(", ")
    };
    let failed = ids(|claim| !claim.holds && claim.is_measured());
    let unmeasured = ids(|claim| !claim.is_measured());
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
        ". "
        @if total == 0 {
        } @else if held == total {
            span.holds { "All " (total) " claims of the paper hold." }
        } @else {
            span.fails { (held) " of the paper's " (total) " claims hold" }
            @if !failed.is_empty() { "; not: " (failed) }
            @if !unmeasured.is_empty() { "; not measured: " (unmeasured) }
            "."
        }
        @if let Some(task) = recording.task.last().filter(|task| task.phase != Phase::Done) {
            " The task was not done: the run ended in " (task.phase) " of stroke " (task.stroke)
            @if !task.reason.is_empty() { ", because " (task.reason) }
            "."
        }
    }
}

/// Strokes that were made from SEARCH to RETURN.
fn strokes_made(recording: &Recording) -> u32 {
    recording.task.last().map_or(0, |task| match task.phase {
        Phase::Done => task.stroke,
        _ => task.stroke.saturating_sub(1),
    })
}

fn claims_table(claims: &[Claim]) -> Markup {
    html! {
        div.scroll {
            table {
                thead { tr { th { "Claim" } th.number { "Value" } th.number { "Bound" } th { "Holds" } } }
                @for claim in claims {
                    tbody.claim {
                        tr {
                            td colspan="3" { (claim.text) " " span.unit { (claim.id) } }
                            td { (holds(claim.holds)) }
                        }
                        @for part in &claim.parts { (part_row(part)) }
                    }
                }
            }
        }
    }
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
            td { @if !part.holds { (holds(false)) } }
        }
    }
}

fn holds(holds: bool) -> Markup {
    html! {
        @if holds { span.holds { "✓ yes" } } @else { span.fails { "✗ no" } }
    }
}

/// One column of the strokes' table: name, unit, and the measure in that unit.
type Column = (
    &'static str,
    &'static str,
    fn(&StrokeMeasures) -> Option<f64>,
);

const STROKE_COLUMNS: [Column; 9] = [
    ("Peak torque", "mN·m", |s| s.peak_torque.map(|v| 1e3 * v)),
    ("Mean grasp force", "N", |s| s.mean_grasp_force),
    ("Peak grasp force", "N", |s| s.peak_grasp_force),
    ("Cap turn", "°", |s| s.cap_turn.map(f64::to_degrees)),
    ("Peak shear rate", "N/s", |s| s.peak_shear_rate),
    ("Slip", "% of MOVE", |s| s.slip_fraction.map(|v| 1e2 * v)),
    ("Inward bend", "mm", |s| s.path_inward_bend.map(|v| 1e3 * v)),
    ("RMS to contour", "mm", |s| {
        s.path_rms_to_contour.map(|v| 1e3 * v)
    }),
    ("Peak element force", "N", |s| s.peak_element_force),
];

/// Measures down, strokes across: four strokes fit a phone.
fn strokes_table(strokes: &[StrokeMeasures]) -> Markup {
    html! {
        div.scroll {
            table {
                thead {
                    tr {
                        th { "Stroke" }
                        @for stroke in strokes { th.number { (stroke.index) } }
                    }
                }
                tbody {
                    @for (name, unit, measure) in STROKE_COLUMNS {
                        tr {
                            td { (name) " " span.unit { "(" (unit) ")" } }
                            @for stroke in strokes { td.number { (value(measure(stroke))) } }
                        }
                    }
                }
            }
        }
    }
}

fn figure_markup(figure: &Figure) -> Markup {
    html! {
        figure id=(format!("fig-{:02}", figure.number)) {
            @match &figure.svg {
                Some(svg) => (PreEscaped(svg)),
                None => div.missing { "Not in this recording." },
            }
            figcaption {
                b { "Fig. " (figure.number) ". " (figure.title) ". " }
                (figure.caption)
            }
        }
    }
}

fn facts_table(facts: &RunFacts, summary: &Summary) -> Markup {
    let unknown = || "unknown".to_string();
    let rows = [
        ("Experiment", facts.experiment.clone()),
        ("Seed", facts.seed.to_string()),
        ("Version of feeler", facts.version.clone()),
        ("Sensing", facts.sensing.clone()),
        ("Fingers", facts.fingers.to_string()),
        (
            "Control period",
            format!("{} ms", significant(1e3 * facts.control_period)),
        ),
        (
            "Cap radius",
            format!("{} mm", significant(1e3 * facts.cap_radius)),
        ),
        (
            "Feeler tip radius",
            format!("{} mm", significant(1e3 * facts.feeler_tip_radius)),
        ),
        (
            "Touch threshold F1",
            format!("{} N", significant(facts.touch_force_threshold)),
        ),
        (
            "Over threshold F2",
            format!("{} N", significant(facts.over_force_threshold)),
        ),
        (
            "Slip threshold dr",
            format!("{} N/s", significant(facts.slip_threshold)),
        ),
        (
            "Grasp threshold",
            format!("{} N", significant(facts.grasp_force_threshold)),
        ),
        (
            "Time on record",
            format!("{} s", significant(summary.sim_time)),
        ),
        (
            "Wall time",
            summary
                .wall_time
                .map_or_else(unknown, |t| format!("{} s", significant(t))),
        ),
        (
            "Real-time factor",
            summary.real_time_factor.map_or_else(unknown, significant),
        ),
    ];
    html! {
        table {
            tbody {
                @for (name, value) in rows { tr { th scope="row" { (name) } td { (value) } } }
            }
        }
    }
}

/// A value, or a dash where there is none.
pub(super) fn value(value: Option<f64>) -> String {
    value.map_or_else(|| "–".into(), significant)
}

/// A number to three significant digits (whole numbers to all), with a true minus sign.
pub(super) fn significant(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return "0".into();
    }
    let magnitude = value.abs();
    let decimals = (2 - magnitude.log10().floor() as i32).clamp(0, 9) as usize;
    let text = format!("{magnitude:.decimals$}");
    let text = if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    match text {
        "0" => "0".into(),
        text if value < 0.0 => format!("\u{2212}{text}"),
        text => text.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::significant;

    #[test]
    fn numbers_have_three_significant_digits() {
        assert_eq!(significant(0.0), "0");
        assert_eq!(significant(4.0), "4");
        assert_eq!(significant(0.029_34), "0.0293");
        assert_eq!(significant(-12.345), "\u{2212}12.3");
        assert_eq!(significant(48.76), "48.8");
        assert_eq!(significant(123_456.0), "123456");
        assert_eq!(significant(-1e-13), "0");
        assert_eq!(significant(0.15), "0.15");
    }
}
