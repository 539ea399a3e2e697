//! `report.html`: a self-contained page for phone, desktop and print.

use super::claims_table::claims_table;
use super::document::{self, Tile, document, facts_table, tiles};
use super::text::significant;
use crate::figures::Figure;
use crate::measures::claim::{Claim, Verdict};
use crate::measures::criterion::Success;
use crate::measures::strokes::StrokeMeasures;
use crate::measures::summary::Summary;
use crate::page_data::{PageData, Rows, RunTable};
use crate::run::data::RunData;
use crate::run::thinned::DecimatedRun;
use crate::tasks;
use crate::tasks::TaskReport;
use feeler_record::{Phase, Recording, RunFacts, RunState};
use maud::{Markup, html};

/// Report page as HTML. `link` is the relative path to the recording; `table` contains the rows of `data`.
pub(crate) fn page(
    recording: &Recording,
    link: &str,
    data: &RunData,
    table: (RunTable, Rows),
    summary: &Summary,
    figures: &[Figure],
) -> String {
    let facts = &recording.facts;
    let task = tasks::of_recording(recording);
    let (claims, whose) = tasks::shown_claims(recording, summary);
    let name = format!("{}, seed {}", facts.experiment, facts.seed);
    let mark = match (recording.complete, summary.state) {
        (false, _) => "INCOMPLETE: ",
        (true, RunState::Interrupted) => "INTERRUPTED: ",
        (true, RunState::Done | RunState::GivenUp) => "",
    };
    let body = html! {
        (banner(recording, summary))
        h1 { "Run report: " (name) }
        @if let Some(original) = &facts.replay_of {
            p.note {
                "This run is a replay. Joint angles, torque and cap are copied from the original recording and do not respond "
                "to the commands shown here. Digest of the original recording: " span.digest { (original) } "."
            }
        }
        p.verdict { (verdict(recording, summary, task, claims, whose)) }
        (tiles(&tiles_of(summary, claims)))
        div id="scene" {}
        h2 { "Figures" }
        @if let Some(thinned) = &data.thinned { (left_out(thinned, data)) }
        (document::figures(figures))
        @if !claims.is_empty() {
            h2 { "Claims " (whose) }
            (claims_table(claims, data))
        }
        (task.measured(recording, summary))
        h2 { "The run" }
        p {
            "Recording: " a href=(link) { (link) } " (opens in Rerun, Foxglove, RViz and Python). "
            "To repeat this run: " code { (again(facts)) } "."
        }
        (facts_table(facts_of(facts, summary)))
        details {
            summary { "Experiment as run (" code { "experiment.toml" } ")" }
            pre { (recording.experiment) }
        }
        p { "Digest of the recording (SHA-256):" br; span.digest { (summary.digest) } }
        p.note {
            "Paper: M. Ohka, N. Morisawa and H. B. Yussof, “Trajectory Generation of Robotic "
            "Fingers Based on Tri-axial Tactile Data for Cap Screwing Task”, 2009. All values on this "
            "page are computed from the recording."
        }
    };
    let page = PageData::of_run(&name, recording, data, table, figures);
    document(&format!("{mark}{name}"), body, &page)
}

/// Note about the data that the page of a long run omits.
fn left_out(thinned: &DecimatedRun, data: &RunData) -> Markup {
    let (all, kept) = (thinned.rows, data.time.len());
    let numbers = thinned.too_long.iter().take(10).map(u32::to_string);
    let too_long = numbers.collect::<Vec<_>>().join(", ");
    html! {
        p.note {
            "This is a long run: figures and scene show " (kept) " of its " (all) " control steps. These are all steps of the "
            "first four strokes, as far as they fit, and elsewhere the extremes of force, shear rate and torque. Claims and "
            "stroke measures use all steps."
            @if !too_long.is_empty() {
                " Only maxima are known for strokes that are too long (" (too_long)
                @if thinned.too_long.len() > 10 { ", …" }
                ")."
            }
        }
    }
}

/// Command that repeats the run.
fn again(facts: &RunFacts) -> String {
    let (experiment, seed, sensing) = (&facts.experiment, facts.seed, &facts.sensing);
    format!("feeler run {experiment} --seed {seed} --sensing {sensing}")
}

/// Key figures, as far as they were measured.
fn tiles_of(summary: &Summary, claims: &[Claim]) -> Vec<Tile> {
    let held = claims.iter().filter(|claim| claim.holds).count();
    let claims = (!claims.is_empty())
        .then(|| Tile::new(format!("{held} of {}", claims.len()), "", "claims pass"));
    let outcome = summary
        .outcome
        .as_ref()
        .map(|outcome| outcome.as_str().to_string());
    let outcome = outcome.unwrap_or_else(|| summary.state.to_string());
    let slip = |stroke: &StrokeMeasures| stroke.true_slip_fraction.or(stroke.slip_fraction);
    let slip = summary.strokes.last().and_then(slip);
    let measure = |value: Option<f64>, factor: f64, unit, label| {
        value.map(|value| Tile::new(significant(factor * value), unit, label))
    };
    let measured = [
        measure(
            summary.final_torque,
            1e3,
            "mN·m",
            "peak torque, last stroke",
        ),
        measure(summary.cap_angle, 1f64.to_degrees(), "°", "cap rotation"),
        measure(
            summary.peak_element_force,
            1.0,
            "N",
            "peak force on an element",
        ),
        measure(slip, 1e2, "%", "slip in the last MOVE"),
        measure(Some(summary.sim_time), 1.0, "s", "recorded time"),
    ];
    let first = [Some(Tile::new(outcome, "", "outcome")), claims];
    first.into_iter().chain(measured).flatten().collect()
}

/// Banner above the report of a damaged recording or an interrupted run.
fn banner(recording: &Recording, summary: &Summary) -> Markup {
    html! {
        @if let (Some(missing), true) = (recording.missing(), recording.problem == recording.missing()) {
            div.incomplete role="alert" {
                "GAP: " (missing) ". Numbers and figures below cover the recorded data only; lines are drawn across "
                "the gap."
            }
        } @else if let Some(problem) = &recording.problem {
            div.incomplete role="alert" {
                "INCOMPLETE: readable up to t = " (format!("{:.2}", recording.readable_until)) " s. "
                "The recording is damaged or the run was interrupted (" (problem) "). "
                "Numbers and figures below cover the readable part only."
            }
        } @else if summary.state == RunState::Interrupted {
            div.incomplete role="alert" {
                "INTERRUPTED at t = " (format!("{:.2}", recording.readable_until)) " s, before the task was completed"
                @if let Some(reason) = &summary.reason { " (" (reason) ")" }
                ". Numbers and figures below cover the run up to that time."
            }
        }
    }
}

/// One-paragraph summary of the run.
fn verdict(
    recording: &Recording,
    summary: &Summary,
    task: &dyn TaskReport,
    claims: &[Claim],
    whose: &str,
) -> Markup {
    let total = claims.len();
    let held = claims.iter().filter(|claim| claim.holds).count();
    let ids = |wanted: fn(&Claim) -> bool| {
        let claims = claims.iter().filter(|claim| wanted(claim));
        claims.map(|claim| claim.id).collect::<Vec<_>>().join(", ")
    };
    let failed = ids(|claim| claim.verdict == Verdict::Fails);
    let unmeasured = ids(|claim| claim.verdict == Verdict::NotMeasured);
    html! {
        @match summary.state {
            RunState::Done => { span.holds { "Done." } }
            state => { span.fails { (capitalised(state)) } ": " (summary.reason.as_deref().unwrap_or("no reason recorded")) "." }
        }
        " " (task.verdict(recording, summary)) " "
        @if total == 0 {
        } @else if held == total {
            span.holds { "All " (total) " claims " (whose) " pass." }
        } @else {
            (held) " of the " (total) " claims " (whose) " pass"
            @if !failed.is_empty() { "; " span.fails { "failed: " (failed) } }
            @if !unmeasured.is_empty() { "; not measured: " (unmeasured) }
            "."
        }
        @if let Some(judged) = summary.success.and_then(Success::beyond_claims) { " " (capitalised(judged)) "." }
        @if let Some(task) = recording.task.last().filter(|task| task.phase != Phase::Done) {
            " The run ended in " (task.phase) " of stroke " (task.stroke)
            @if !task.reason.is_empty() { ", because " (task.reason) }
            "."
        }
    }
}

/// Text with its first letter capitalized.
fn capitalised(text: impl ToString) -> String {
    let text = text.to_string();
    let mut letters = text.chars();
    let first = letters.next().map(|letter| letter.to_ascii_uppercase());
    first.into_iter().chain(letters).collect()
}

/// Names and values of the run's constants.
fn facts_of(facts: &RunFacts, summary: &Summary) -> [(&'static str, String); 15] {
    let with_unit = |value: f64, unit: &str| format!("{} {unit}", significant(value));
    let known = |value: Option<String>| value.unwrap_or_else(|| "unknown".into());
    // Recorded only by the simulator.
    let tip_radius = Some(facts.feeler_tip_radius).filter(|&radius| radius > 0.0);
    let tip_radius = known(tip_radius.map(|radius| with_unit(1e3 * radius, "mm")));
    let wall_time = known(summary.wall_time.map(|time| with_unit(time, "s")));
    let factor = known(summary.real_time_factor.map(significant));
    let grasp_force = with_unit(facts.grasp_force_threshold, "N");
    [
        ("Experiment", facts.experiment.clone()),
        ("Task", facts.task.to_string()),
        ("Seed", facts.seed.to_string()),
        ("feeler version", facts.version.clone()),
        ("Sensing", facts.sensing.to_string()),
        ("Fingers", facts.fingers.to_string()),
        (
            "Control period",
            with_unit(1e3 * facts.control_period, "ms"),
        ),
        ("Feeler tip radius", tip_radius),
        (
            "Touch threshold F1",
            with_unit(facts.touch_force_threshold, "N"),
        ),
        (
            "Over threshold F2",
            with_unit(facts.over_force_threshold, "N"),
        ),
        ("Slip threshold dr", with_unit(facts.slip_threshold, "N/s")),
        ("Grasp force threshold or load", grasp_force),
        ("Recorded time", with_unit(summary.sim_time, "s")),
        ("Wall time", wall_time),
        ("Real-time factor", factor),
    ]
}
