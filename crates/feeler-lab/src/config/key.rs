//! Flattens an experiment into key-value pairs and resolves abbreviated keys.

use crate::config::ExperimentConfig;
use strsim::damerau_levenshtein as distance;
use toml::Value;

/// Name under which a sweep varies all friction coefficients together. As the name of a single key it is ambiguous.
pub const FRICTION: &str = "friction";

/// Returns every scalar value of an experiment with its dotted key, defaults included.
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

/// Returns the number in `value`, or `None` if it is not numeric.
pub fn number(value: &Value) -> Option<f64> {
    value
        .as_float()
        .or_else(|| value.as_integer().map(|whole| whole as f64))
}

/// Finds the only key that matches `name`, which may be abbreviated.
///
/// # Errors
/// If no key or several keys match, a message that lists candidates.
pub fn find<'a>(name: &str, leaves: &'a [(String, Value)]) -> Result<&'a (String, Value), String> {
    if name == "seed" {
        return Err("seed cannot be varied, because every trial has a separate seed; set the seed of the sweep with --seed".into());
    }
    if let Some(exact) = leaves.iter().find(|(key, _)| key == name) {
        return Ok(exact);
    }
    // "friction" is a variation of all coefficients; as a key, it is ambiguous among them.
    let is_meant = |key: &str| match name {
        FRICTION => key.ends_with(FRICTION),
        name => means(name, key),
    };
    let meant: Vec<_> = leaves.iter().filter(|(key, _)| is_meant(key)).collect();
    match meant[..] {
        [one] => Ok(one),
        [] => Err(format!(
            "there is no parameter {name:?}; similar names: {}",
            nearest(name, leaves).join(", ")
        )),
        _ => {
            let keys: Vec<_> = meant.iter().take(12).map(|(key, _)| key.as_str()).collect();
            Err(format!(
                "{name:?} could mean any of {}; use a longer part of the key",
                keys.join(", ")
            ))
        }
    }
}

/// Returns `true` if the segments of `name` occur in `key` in this order and both end with the same segment.
fn means(name: &str, key: &str) -> bool {
    let mut segments = key.split('.').rev();
    let mut names = name.split('.').rev();
    if names.next() != segments.next() {
        return false;
    }
    names.all(|name| segments.any(|segment| segment == name))
}

/// Returns the keys whose last segment is most similar to the last segment of `name`.
fn nearest(name: &str, leaves: &[(String, Value)]) -> Vec<String> {
    let last = |key: &str| key.rsplit('.').next().unwrap_or(key).to_string();
    let mut ranked: Vec<_> = leaves
        .iter()
        .map(|(key, _)| (distance(&last(name), &last(key)), key.clone()))
        .collect();
    ranked.sort();
    ranked.into_iter().take(4).map(|(_, key)| key).collect()
}

/// Returns the end of an error message that suggests the most similar of `names`, or an empty string if none is
/// similar to `name`.
pub fn did_you_mean<'a>(name: &str, names: impl Iterator<Item = &'a str>) -> String {
    /// Maximum fraction of letters in which a suggested name differs from the given one.
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
    fn a_name_matches_the_only_key_with_its_segments() {
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
