//! What varies: `--vary NAME=DISTRIBUTION`, and the key of the experiment that NAME means.

use super::SweepError;
use super::distribution::{Distribution, number_text};
use crate::config::{Experiment, ExperimentConfig};
use toml::Value;

/// The name that means the static friction of all feelers and objects, the kinetic in proportion.
pub const FRICTION: &str = "friction";

/// A varied parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// As it was called; also the name of its column.
    pub name: String,
    /// What it is drawn from.
    pub distribution: Distribution,
    /// Whether it takes whole numbers only.
    pub whole: bool,
    target: Target,
}

#[derive(Debug, Clone, PartialEq)]
enum Target {
    Key(String),
    /// Keys of static and kinetic friction, and kinetic by static.
    Friction(Vec<(String, String, f64)>),
}

impl Parameter {
    /// Reads `NAME=DISTRIBUTION` for an experiment, and checks that its bounds are in range.
    ///
    /// # Errors
    /// When it does not parse, names no parameter or more than one, or is out of range.
    pub fn parse(expression: &str, experiment: &Experiment) -> Result<Self, SweepError> {
        let error = |message: String| SweepError::Vary {
            expression: expression.to_string(),
            message,
        };
        let (name, distribution) = expression.split_once('=').ok_or_else(|| {
            error("expected NAME=DISTRIBUTION, as in friction=uniform(0.3,1.2)".into())
        })?;
        let name = name.trim().to_string();
        let distribution = Distribution::parse(distribution).map_err(error)?;
        let leaves = leaves(&experiment.config);
        let (target, kind) = if name == FRICTION {
            (Target::Friction(frictions(&leaves)), Value::Float(0.0))
        } else {
            let (key, value) = find(&name, &leaves).map_err(error)?;
            (Target::Key(key.clone()), value.clone())
        };
        let whole = kind.is_integer();
        let numeric = whole || kind.is_float();
        if !numeric && !matches!(distribution, Distribution::Choice(_)) {
            return Err(error(format!(
                "{name} is no number: expected choice(a,b,…)"
            )));
        }
        let parameter = Self {
            name,
            distribution,
            whole,
            target,
        };
        for value in parameter.distribution.extremes(whole) {
            let settings = parameter.settings(&value).map_err(error)?;
            let folder = Some(experiment.folder().to_path_buf());
            Experiment::parse(&experiment.toml, "the experiment", &settings, folder)
                .map_err(|e| error(e.to_string()))?;
        }
        Ok(parameter)
    }

    /// Whether both set the same key.
    pub fn overlaps(&self, other: &Self) -> bool {
        let keys = |parameter: &Self| match &parameter.target {
            Target::Key(key) => vec![key.clone()],
            Target::Friction(keys) => (keys.iter())
                .flat_map(|(fixed, sliding, _)| [fixed.clone(), sliding.clone()])
                .collect(),
        };
        let theirs = keys(other);
        keys(self).iter().any(|key| theirs.contains(key))
    }

    /// The settings that give it the value that this text says.
    ///
    /// # Errors
    /// When the text is no number where one is needed.
    pub fn settings(&self, value: &str) -> Result<Vec<String>, String> {
        match &self.target {
            Target::Key(key) => Ok(vec![format!("{key}={value}")]),
            Target::Friction(keys) => {
                let friction: f64 = (value.parse())
                    .map_err(|_| format!("{value:?} is no coefficient of friction"))?;
                let settings = keys.iter().flat_map(|(fixed, sliding, ratio)| {
                    let kinetic = number_text(friction * ratio, false);
                    [
                        format!("{fixed}={}", number_text(friction, false)),
                        format!("{sliding}={kinetic}"),
                    ]
                });
                Ok(settings.collect())
            }
        }
    }
}

/// Every single value of an experiment with its key, defaults included.
fn leaves(config: &ExperimentConfig) -> Vec<(String, Value)> {
    let mut found = Vec::new();
    if let Ok(value) = Value::try_from(config) {
        collect("", value, &mut found);
    }
    found
}

fn collect(key: &str, value: Value, found: &mut Vec<(String, Value)>) {
    let below = |part: &str| match key {
        "" => part.to_string(),
        key => format!("{key}.{part}"),
    };
    match value {
        Value::Table(table) => {
            for (part, value) in table {
                collect(&below(&part), value, found);
            }
        }
        Value::Array(values) => {
            for (index, value) in values.into_iter().enumerate() {
                collect(&below(&index.to_string()), value, found);
            }
        }
        single => found.push((key.to_string(), single)),
    }
}

fn frictions(leaves: &[(String, Value)]) -> Vec<(String, String, f64)> {
    let number = |key: &str| {
        let found = leaves.iter().find(|(k, _)| k == key);
        found.and_then(|(_, value)| value.as_float())
    };
    let fixed = leaves.iter().filter_map(|(key, value)| {
        let sliding = format!("{}kinetic_friction", key.strip_suffix("static_friction")?);
        let (fixed, kinetic) = (value.as_float()?, number(&sliding)?);
        let ratio = if fixed > 0.0 { kinetic / fixed } else { 1.0 };
        Some((key.clone(), sliding, ratio))
    });
    fixed.collect()
}

/// The one key that `name` means.
fn find<'a>(name: &str, leaves: &'a [(String, Value)]) -> Result<&'a (String, Value), String> {
    if name == "seed" {
        return Err("every trial has a seed of its own anyway: set the sweep's with --seed".into());
    }
    if let Some(exact) = leaves.iter().find(|(key, _)| key == name) {
        return Ok(exact);
    }
    let meant: Vec<_> = leaves.iter().filter(|(key, _)| means(name, key)).collect();
    match meant[..] {
        [one] => Ok(one),
        [] => Err(format!(
            "there is no parameter {name:?}; the nearest are {}",
            nearest(name, leaves).join(", ")
        )),
        _ => {
            let keys: Vec<_> = meant.iter().take(12).map(|(key, _)| key.as_str()).collect();
            Err(format!(
                "{name:?} could mean any of {}; say more of it",
                keys.join(", ")
            ))
        }
    }
}

/// Whether the segments of `name` stand in `key` in this order, the last one last.
fn means(name: &str, key: &str) -> bool {
    let mut segments = key.split('.').rev();
    let mut names = name.split('.').rev();
    if names.next() != segments.next() {
        return false;
    }
    names.all(|name| segments.any(|segment| segment == name))
}

/// The keys whose last segments are spelt most like `name`'s.
fn nearest(name: &str, leaves: &[(String, Value)]) -> Vec<String> {
    let last = |key: &str| key.rsplit('.').next().unwrap_or(key).to_string();
    let mut ranked: Vec<_> = leaves
        .iter()
        .map(|(key, _)| (distance(&last(name), &last(key)), key.clone()))
        .collect();
    ranked.sort();
    ranked.into_iter().take(4).map(|(_, key)| key).collect()
}

/// Letters to change, add or leave out (Levenshtein).
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let changed = diagonal + usize::from(x != *y);
            diagonal = row[j + 1];
            row[j + 1] = changed.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_means_the_one_key_that_has_its_segments() {
        let experiment = Experiment::load("cap-closing", &[]).unwrap();
        let key = |name: &str| find(name, &leaves(&experiment.config)).map(|(key, _)| key.clone());
        assert_eq!(
            key("cap.radius").unwrap(),
            "sim.object.cap.shape.cylinder.radius"
        );
        assert_eq!(key("slip_threshold").unwrap(), "control.slip_threshold");
        assert!(key("elements").unwrap_err().contains("could mean any of"));
        assert!(
            key("slip_treshold")
                .unwrap_err()
                .contains("control.slip_threshold")
        );
    }

    #[test]
    fn friction_keeps_its_proportion() {
        let experiment = Experiment::load("cap-closing", &[]).unwrap();
        let friction = Parameter::parse("friction=uniform(0.3,1.2)", &experiment).unwrap();
        let settings = friction.settings("0.5").unwrap();
        assert_eq!(
            settings,
            [
                "sim.feeler.static_friction=0.5",
                "sim.feeler.kinetic_friction=0.30637254901960786"
            ]
        );
    }
}
