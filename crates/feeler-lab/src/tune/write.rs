//! Writes tuned values and comments to the text of an experiment.

use super::TuneError;
use super::hand::screw;
use super::rules::RULES;
use super::settings::Settings;
use crate::config::{Experiment, ExperimentConfig};
use feeler::control::ControlConfig;
use feeler::control::task::screw::ScrewConfig;
use toml_edit::{DocumentMut, Item};

/// A tuned value of the experiment.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// Key in the experiment file.
    pub key: String,
    /// Unit of the values.
    pub unit: &'static str,
    /// Original value.
    pub before: f64,
    /// The tuned value.
    pub after: f64,
    /// The ratio that the rule computes and its physical reason, as text.
    pub reason: String,
}

/// Method by which settings were found, for comments.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// Computed by the tuning rules.
    Rules,
    /// Found by a search around the values of the tuning rules.
    Search,
}

impl Origin {
    fn words(self) -> &'static str {
        match self {
            Self::Rules => "tuned by rule",
            Self::Search => "tuned by search about the rule",
        }
    }
}

/// A setting: key within its table, unit, value, and index of its rule.
type Setting<C> = (&'static str, &'static str, fn(&C) -> f64, usize);

/// Comment on the value of F1, which is computed from F2.
const TOUCH: &str = "F1 / F2: as in the reference experiment";

const CONTROL: [Setting<ControlConfig>; 4] = [
    ("over_force", "N", |c| c.over_force, 0),
    ("slip_threshold", "N/s", |c| c.slip_threshold, 2),
    ("recompression_speed", "m/s", |c| c.recompression_speed, 3),
    ("minimum_grasp_force", "N", |c| c.minimum_grasp_force, 4),
];

const SCREW: [Setting<ScrewConfig>; 4] = [
    ("grasp_force", "N", |c| c.grasp_force, 5),
    ("search_speed", "m/s", |c| c.search_speed, 6),
    ("move_speed", "m/s", |c| c.move_speed, 1),
    ("travel", "m", |c| c.travel, 7),
];

/// Index in [`RULES`] of the rule for the start of the stroke.
const START: usize = 8;

/// Returns the values of `experiment` that `settings` changes. The object turns about `pivot` (x and y in W, m).
///
/// # Errors
/// If the experiment has no `[task.screw]`.
pub fn changes(
    experiment: &Experiment,
    settings: &Settings,
    pivot: [f64; 2],
) -> Result<Vec<Change>, TuneError> {
    let mut tuned = experiment.clone();
    settings.apply(&mut tuned.config, pivot);
    let (old, new) = (&experiment.config.control, &tuned.config.control);
    let (before, after) = (screw(experiment)?, screw(&tuned)?);
    let rule = |index: usize| format!("{}: {}", RULES[index].name, RULES[index].reason);
    let change = |key: String, unit, before, after, reason| Change {
        key,
        unit,
        before,
        after,
        reason,
    };
    let key = "control.touch_force".to_string();
    let touch = change(
        key,
        "N",
        old.touch_force,
        new.touch_force,
        TOUCH.to_string(),
    );
    let control = CONTROL.map(|(key, unit, value, index)| {
        let key = format!("control.{key}");
        change(key, unit, value(old), value(new), rule(index))
    });
    let task = SCREW.map(|(key, unit, value, index)| {
        let key = format!("task.screw.{key}");
        change(key, unit, value(before), value(after), rule(index))
    });
    let fingers = before.finger.iter().zip(&after.finger).enumerate();
    let homes = fingers.flat_map(|(finger, (old, new))| {
        let axes = old.home.into_iter().zip(new.home).enumerate();
        axes.map(move |(axis, (old, new))| {
            let key = format!("task.screw.finger.{finger}.home.{axis}");
            change(key, "m", old, new, rule(START))
        })
    });
    let all = [touch].into_iter().chain(control).chain(task).chain(homes);
    Ok(all.filter(|c| c.before != c.after).collect())
}

/// Applies `changes` to `experiment`, with a comment about the origin of each value.
///
/// # Errors
/// If a value is out of range.
pub fn tuned(
    experiment: &Experiment,
    changes: &[Change],
    origin: Origin,
) -> Result<Experiment, TuneError> {
    let settings = changes.iter().map(|c| format!("{}={:?}", c.key, c.after));
    let settings: Vec<String> = settings.collect();
    let mut plain = experiment.with_settings(&settings)?;
    let mut document: DocumentMut = match plain.toml.parse() {
        Ok(document) => document,
        Err(_) => return Ok(plain),
    };
    for Change {
        key, unit, reason, ..
    } in changes
    {
        let comment = format!("  # {unit}; {}: {reason}", origin.words());
        comment_on(document.as_item_mut(), key, comment);
    }
    let toml = document.to_string();
    // Within an inline table, a comment would hide the rest of the line.
    let reads = toml::from_str::<ExperimentConfig>(&toml).is_ok_and(|c| c == plain.config);
    if reads {
        plain.toml = toml;
    }
    Ok(plain)
}

/// Appends `comment` to the value of `key`, or to its list if the value is an element of a list.
fn comment_on(document: &mut Item, key: &str, comment: String) {
    let mut item = document;
    for part in key.split('.') {
        let next = match part.parse::<usize>() {
            Ok(index) => item.get_mut(index),
            Err(_) => item.get_mut(part),
        };
        let Some(next) = next else { return };
        item = next;
        if let Some(value) = item.as_value_mut() {
            value.decor_mut().set_suffix(comment);
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings() -> Settings {
        Settings {
            over_force: 0.6,
            move_speed: 0.007,
            slip_threshold: 8.0,
            recompression_speed: 0.005,
            minimum_grasp_force: 0.09,
            grasp_force: 1.1,
            search_speed: 0.002,
            travel: 0.009,
            start: 0.002,
            touch_force: 0.12,
        }
    }

    fn strip(line: &str) -> &str {
        line.split('#').next().unwrap_or_default().trim()
    }

    /// Only the lines of tuned values differ.
    #[test]
    fn only_tuned_values_differ() {
        let experiment = Experiment::load("cap-closing", &[]).unwrap();
        let changes = changes(&experiment, &settings(), [0.0, 0.0]).unwrap();
        assert_eq!(changes.len(), 11);
        let tuned = tuned(&experiment, &changes, Origin::Rules).unwrap();
        let lines = || experiment.toml.lines().zip(tuned.toml.lines());
        assert_eq!(experiment.toml.lines().count(), tuned.toml.lines().count());
        let differing: Vec<_> = lines().filter(|(a, b)| a != b).collect();
        assert_eq!(differing.len(), changes.len());
        for (before, after) in differing {
            assert!(after.contains("; tuned by rule: "), "{after}");
            let key = |line: &str| strip(line).split('=').next().unwrap().trim().to_string();
            assert_eq!(key(before), key(after));
        }
        let mut expected = experiment.config.clone();
        settings().apply(&mut expected, [0.0, 0.0]);
        assert_eq!(tuned.config, expected);
    }

    /// Keys that were omitted because of their defaults are added.
    #[test]
    fn missing_keys_are_added() {
        let toml = Experiment::load("cap-closing", &[]).unwrap().toml;
        let keys = ["slip_threshold", "travel", "touch_force"];
        let short = toml
            .lines()
            .filter(|line| !keys.iter().any(|key| line.starts_with(key)));
        let short: String = short.map(|line| format!("{line}\n")).collect();
        let experiment = Experiment::parse(&short, "short", &[], None).unwrap();
        let changes = changes(&experiment, &settings(), [0.0, 0.0]).unwrap();
        let tuned = tuned(&experiment, &changes, Origin::Search).unwrap();
        assert_eq!(tuned.config.control.slip_threshold, 8.0);
        assert!(
            tuned
                .toml
                .contains("slip_threshold = 8.0  # N/s; tuned by search about the rule: dr")
        );
    }
}
