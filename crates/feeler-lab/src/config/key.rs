//! The values of an experiment by key, and the key that a name means.

use crate::config::ExperimentConfig;
use strsim::damerau_levenshtein as distance;
use toml::Value;

/// Name by which a sweep varies all friction coefficients together. As the name of a single key it is ambiguous.
pub const FRICTION: &str = "friction";

/// Every single value of an experiment with its key, defaults included.
pub fn leaves(config: &ExperimentConfig) -> Vec<(String, Value)> {
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

/// The number that a value is, if it is one.
pub fn number(value: &Value) -> Option<f64> {
    value
        .as_float()
        .or_else(|| value.as_integer().map(|whole| whole as f64))
}

/// The one key that `name` means.
///
/// # Errors
/// When there is none, or more than one, in words.
pub fn find<'a>(name: &str, leaves: &'a [(String, Value)]) -> Result<&'a (String, Value), String> {
    if name == "seed" {
        return Err("every trial has a seed of its own anyway: set the sweep's with --seed".into());
    }
    if let Some(exact) = leaves.iter().find(|(key, _)| key == name) {
        return Ok(exact);
    }
    // Only the variation of the coefficients is called so, but the coefficients may be meant.
    let is_meant = |key: &str| match name {
        FRICTION => key.ends_with(FRICTION),
        name => means(name, key),
    };
    let meant: Vec<_> = leaves.iter().filter(|(key, _)| is_meant(key)).collect();
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

/// End of an error message that suggests the most similar of `names`; empty if none is similar to `name`.
pub fn did_you_mean<'a>(name: &str, names: impl Iterator<Item = &'a str>) -> String {
    /// Largest part of the letters that may differ.
    const DIFFERENT: f64 = 1.0 / 3.0;
    let most = (DIFFERENT * name.len() as f64).ceil() as usize;
    let like = names.map(|other| (distance(name, other), other)).min();
    match like.filter(|(letters, _)| *letters <= most) {
        Some((_, other)) => format!("; did you mean {other}?"),
        None => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Experiment;

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
        let friction = key("friction").unwrap_err();
        assert!(
            friction.contains("sim.feeler.static_friction")
                && friction.contains("sim.variation.friction"),
            "{friction}"
        );
        assert_eq!(key("variation.friction").unwrap(), "sim.variation.friction");
        assert!(
            key("slip_treshold")
                .unwrap_err()
                .contains("control.slip_threshold")
        );
    }
}
