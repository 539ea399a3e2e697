//! Report of the friction scan: measured coefficients, compared with ground truth if known.

use super::task_report::TaskReport;
use crate::claims::hand::no_damage;
use crate::figures::{Figure, friction};
use crate::measures::claim::{Claim, part};
use crate::measures::strokes::StrokeMeasures;
use crate::measures::summary::Summary;
use crate::pages::document::{number_heads, numbers, table};
use crate::pages::text::{significant, value};
use crate::run::data::RunData;
use feeler_record::{FindingName, Recording, RunFacts};
use maud::{Markup, html};

/// Maximum relative error of a coefficient.
const TOLERANCE: f64 = 0.05;

/// Coefficients: name of the finding and table label.
const COEFFICIENTS: [(FindingName, &str); 2] = [
    (FindingName::StaticFriction, "Static coefficient"),
    (FindingName::KineticFriction, "Kinetic coefficient"),
];

/// Report of the friction scan.
pub struct FrictionScanReport;

impl TaskReport for FrictionScanReport {
    fn claims(&self, _: &Recording, data: &RunData, _: &[StrokeMeasures]) -> Vec<Claim> {
        let error = |name| Some(data.findings.get(name)? / true_value(&data.facts, name)? - 1.0);
        let within = |id, text, name, part_name| {
            let part = part(part_name).within(error(name), TOLERANCE);
            Claim::new(id, text, vec![part])
        };
        vec![
            within(
                "static-friction",
                "The static coefficient is within 5 % of the true value.",
                &FindingName::StaticFriction,
                "relative error of the static coefficient",
            ),
            within(
                "kinetic-friction",
                "The kinetic coefficient is within 5 % of the true value.",
                &FindingName::KineticFriction,
                "relative error of the kinetic coefficient",
            ),
            no_damage(data),
        ]
    }

    fn figures(&self, _: &Recording, data: &RunData) -> Vec<Figure> {
        let truth = COEFFICIENTS.map(|(name, _)| true_value(&data.facts, &name));
        vec![
            friction::forces(data),
            friction::ratio(data),
            friction::path(data),
            friction::found_and_true(data, truth),
        ]
    }

    fn verdict(&self, _: &Recording, summary: &Summary) -> Markup {
        let found = |name| value(summary.findings.get(name).copied().flatten());
        html! {
            "In " (significant(summary.sim_time)) " s the finger measured a static coefficient of friction of "
            (found(&FindingName::StaticFriction)) " and a kinetic one of " (found(&FindingName::KineticFriction))
            @if let Some(outcome) = &summary.outcome { " (" (outcome) ")" }
            "."
        }
    }

    fn measured(&self, recording: &Recording, summary: &Summary) -> Markup {
        let found = |name| summary.findings.get(name).copied().flatten();
        let coefficients = COEFFICIENTS.iter().map(|(name, words)| {
            let truth = true_value(&recording.facts, name);
            let error = found(name).zip(truth);
            let error = error.map(|(found, truth)| 100.0 * (found / truth - 1.0));
            html! {
                td { (words) }
                (numbers([value(found(name)), value(truth)]))
                td.number { (value(error)) " " span.unit { "%" } }
            }
        });
        let tilt = found(&FindingName::Tilt).map(f64::to_degrees);
        let others = [
            html! {
                td { "Tilt of the specimen along the slide" }
                td.number { (value(tilt)) " " span.unit { "°" } } td {} td {}
            },
            html! { td { "Number of slips" } td.number { (value(found(&FindingName::Slips))) } td {} td {} },
        ];
        let head = html! { th {} (number_heads(["Measured", "True", "Error"])) };
        html! {
            h2 { "Friction" }
            (table(head, coefficients.chain(others)))
        }
    }
}

/// True value of `name`, if the run's facts contain it for exactly one object.
fn true_value(facts: &RunFacts, name: &FindingName) -> Option<f64> {
    let mut known = facts.truth.iter().filter(|(key, _)| {
        let of = key.strip_suffix(name.as_str());
        of.is_some_and(|object| object.ends_with('.'))
    });
    match (known.next(), known.next()) {
        (Some((_, &value)), None) => Some(value),
        _ => None,
    }
}
