//! Varied parameters and the keys that they set, from `--vary NAME=DISTRIBUTION` or from an entry of a file of ranges
//! ([`Entry`]), which can link several keys.

use super::distribution::{Distribution, number_text};
use super::multiplier::Multiplier;
use super::ranges::Entry;
use crate::config::Experiment;
use crate::config::key::{FRICTION, find, leaves, number};
use crate::sweep::SweepError;
use feeler::control::law::LawConfig;
use toml::Value;

/// Maximum relative difference of linked values that count as equal, about 12 digits.
const SAME: f64 = 1e-12;

/// A varied parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Name as given by the user; also the name of its column.
    pub name: String,
    /// Distribution of the value.
    pub distribution: Distribution,
    /// `true` if the values are integers.
    pub whole: bool,
    /// Value in the experiment, as text.
    pub nominal: String,
    /// Text that specified the parameter, for messages.
    said: String,
    /// Keys to set, each to the value times a factor.
    keys: Vec<(String, f64)>,
    /// Additional common factor of all keys.
    of: Option<Multiplier>,
}

impl Parameter {
    /// Parses `NAME=DISTRIBUTION` for an experiment and verifies that the bounds are in range.
    ///
    /// # Errors
    /// If the expression is invalid, the name matches no key or several keys, or a value is out of range.
    pub fn parse(expression: &str, experiment: &Experiment) -> Result<Self, SweepError> {
        let said = format!("--vary {expression}");
        let parameter = Self::unchecked(expression, &said, experiment)
            .map_err(|message| SweepError::Vary { said, message })?;
        for value in parameter.distribution.extremes(parameter.whole) {
            check(experiment, &[(&parameter, &value)], &parameter)?;
        }
        Ok(parameter)
    }

    fn unchecked(expression: &str, said: &str, experiment: &Experiment) -> Result<Self, String> {
        let (name, range) = expression
            .split_once('=')
            .ok_or("expected NAME=DISTRIBUTION, as in friction=uniform(0.3,1.2)")?;
        let name = name.trim();
        let leaves = leaves(&experiment.config);
        // Static friction of all feelers and objects, with kinetic friction in proportion.
        let (keys, value) = if name == FRICTION {
            let keys = frictions(&leaves);
            let first = keys.first().and_then(|(key, _)| find(key, &leaves).ok());
            (keys, first.map_or(Value::Float(0.0), |(_, v)| v.clone()))
        } else {
            let (key, value) = find(name, &leaves)?;
            (vec![(key.clone(), 1.0)], value.clone())
        };
        Self::new(name, said, range, keys, None, &value)
    }

    /// Creates the parameter of an entry of a file of ranges. Call [`check_together`] to check its bounds, because
    /// some bounds are valid only in combination with other parameters.
    ///
    /// # Errors
    /// If the entry has no keys, their values are not in the ratio of the factors, or the range is invalid.
    pub fn of_entry(entry: &Entry, experiment: &Experiment) -> Result<Self, SweepError> {
        let said = format!("parameter {:?}", entry.name);
        let made = Self::linked(entry, &said, experiment);
        made.map_err(|message| SweepError::Vary { said, message })
    }

    fn linked(entry: &Entry, said: &str, experiment: &Experiment) -> Result<Self, String> {
        let leaves = leaves(&experiment.config);
        let of = Multiplier::of_entry(entry, &leaves)?;
        let links = entry.links()?;
        let scale = |factor: f64| factor * of.as_ref().map_or(1.0, Multiplier::nominal);
        let mut keys = Vec::new();
        let mut nominal: Option<Value> = None;
        for (name, factor) in links {
            let (key, value) = find(&name, &leaves)?;
            keys.push((key.clone(), factor));
            let own = match number(value) {
                // Unscaled, so that integers remain integers and nothing is rounded.
                _ if scale(factor) == 1.0 => value.clone(),
                Some(number) => Value::Float(number / scale(factor)),
                None => return Err(format!("{key} is not a number and cannot be multiplied")),
            };
            match &nominal {
                None => nominal = Some(own),
                Some(first) if same(first, &own) => {}
                Some(first) => {
                    return Err(format!(
                        "the experiment has {first} for the first key and {own} for {key}; expected equal values after division by the factors"
                    ));
                }
            }
        }
        let nominal = nominal.ok_or("the parameter sets no key")?;
        Self::new(&entry.name, said, &entry.range, keys, of, &nominal)
    }

    fn new(
        name: &str,
        said: &str,
        range: &str,
        keys: Vec<(String, f64)>,
        of: Option<Multiplier>,
        nominal: &Value,
    ) -> Result<Self, String> {
        let distribution = Distribution::parse(range, number(nominal))?;
        let whole = nominal.is_integer();
        if number(nominal).is_none() && !matches!(distribution, Distribution::Choice(_)) {
            return Err(format!("{name} is not a number: expected choice(a,b,…)"));
        }
        Ok(Self {
            name: name.to_string(),
            distribution,
            whole,
            nominal: match nominal {
                Value::Float(number) => number_text(*number, false),
                other => other.to_string(),
            },
            said: said.to_string(),
            keys,
            of,
        })
    }

    /// Returns a message if both parameters set the same key, or if `later` sets a key by which this parameter is
    /// multiplied.
    pub fn conflict(&self, later: &Self) -> Option<String> {
        let sets = |key: &str| later.keys.iter().any(|(other, _)| other == key);
        let both = self.keys.iter().find(|(key, _)| sets(key));
        let both = both.map(|_| format!("sets the same key as {}", self.name));
        both.or_else(|| {
            let Multiplier { key, .. } = self.of.as_ref().filter(|of| sets(&of.key))?;
            let name = &self.name;
            Some(format!(
                "varies {key}, by which {name} is multiplied: move this parameter before {name}"
            ))
        })
    }

    /// Returns `true` if the parameter sets this key of the experiment.
    pub fn sets(&self, key: &str) -> bool {
        self.keys.iter().any(|(own, _)| own == key)
    }

    /// Returns an error about this parameter.
    pub fn error(&self, message: String) -> SweepError {
        let said = self.said.clone();
        SweepError::Vary { said, message }
    }

    /// Returns the settings that assign `value` to the parameter, after the settings `earlier`.
    fn settings(&self, value: &str, earlier: &[String]) -> Result<Vec<String>, SweepError> {
        let of = self.of.as_ref().map_or(1.0, |of| of.after(earlier));
        let keys = self.keys.iter().map(|(key, factor)| {
            let factor = factor * of;
            if factor == 1.0 {
                return Ok(format!("{key}={value}"));
            }
            let number: Result<f64, _> = value.parse();
            let number = number.map_err(|_| {
                self.error(format!(
                    "{value:?} is not a number and cannot be multiplied"
                ))
            })?;
            Ok(format!("{key}={}", number_text(factor * number, false)))
        });
        keys.collect()
    }
}

/// Returns the settings that assign each parameter its value, in order.
///
/// # Errors
/// If a value must be multiplied but is not a number.
pub fn settings<'a>(
    values: impl IntoIterator<Item = (&'a Parameter, &'a String)>,
) -> Result<Vec<String>, SweepError> {
    let mut settings = Vec::new();
    for (parameter, value) in values {
        let own = parameter.settings(value, &settings)?;
        settings.extend(own);
    }
    Ok(settings)
}

/// Requires that no two parameters set the same key, and that a key used as a multiplier is set before its use.
///
/// # Errors
/// Describes the first conflict.
pub fn check_conflicts(parameters: &[Parameter]) -> Result<(), SweepError> {
    for (index, parameter) in parameters.iter().enumerate() {
        let mut earlier = parameters[..index].iter();
        if let Some(conflict) = earlier.find_map(|other| other.conflict(parameter)) {
            return Err(parameter.error(conflict));
        }
    }
    Ok(())
}

/// Checks both bounds of each parameter while all others have their nominal values.
///
/// # Errors
/// Describes the first value that is out of range.
pub fn check_together(parameters: &[Parameter], experiment: &Experiment) -> Result<(), SweepError> {
    for (index, parameter) in parameters.iter().enumerate() {
        for value in parameter.distribution.extremes(parameter.whole) {
            let value_of = |(other, p): (usize, &'_ Parameter)| match other == index {
                true => value.clone(),
                false => p.nominal.clone(),
            };
            let values: Vec<String> = parameters.iter().enumerate().map(value_of).collect();
            let all: Vec<_> = parameters.iter().zip(&values).collect();
            check(experiment, &all, parameter)?;
        }
    }
    Ok(())
}

fn check(
    experiment: &Experiment,
    values: &[(&Parameter, &String)],
    blame: &Parameter,
) -> Result<(), SweepError> {
    let settings = settings(values.iter().copied())?;
    let varied = experiment.with_settings(&settings);
    let varied = varied.map_err(|e| blame.error(e.to_string()))?;
    let (law, own) = (&varied.config.control.law, &experiment.config.control.law);
    match law {
        LawConfig::Policy(_) if law != own => Err(blame.error(
            "a sweep has one policy; expected another law, or `feeler compare --policy`".into(),
        )),
        _ => Ok(()),
    }
}

fn same(a: &Value, b: &Value) -> bool {
    match (number(a), number(b)) {
        (Some(a), Some(b)) => (a - b).abs() <= SAME * a.abs().max(b.abs()),
        _ => a == b,
    }
}

/// Returns the keys of all friction coefficients, each with its factor: 1 for static friction, and the experiment's
/// ratio of kinetic to static friction for kinetic friction.
fn frictions(leaves: &[(String, Value)]) -> Vec<(String, f64)> {
    let number = |key: &str| {
        let found = leaves.iter().find(|(k, _)| k == key);
        found.and_then(|(_, value)| value.as_float())
    };
    let fixed = leaves.iter().filter_map(|(key, value)| {
        let sliding = format!("{}kinetic_friction", key.strip_suffix("static_friction")?);
        let (fixed, kinetic) = (value.as_float()?, number(&sliding)?);
        let ratio = if fixed > 0.0 { kinetic / fixed } else { 1.0 };
        Some([(key.clone(), 1.0), (sliding, ratio)])
    });
    fixed.flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reference() -> Experiment {
        Experiment::load("cap-closing", &[]).unwrap()
    }

    #[test]
    fn friction_coefficients_keep_their_ratio() {
        let experiment = Experiment::load(
            "cap-closing",
            &[
                "sim.feeler.static_friction=1.02".to_string(),
                "sim.feeler.kinetic_friction=0.625".to_string(),
            ],
        );
        let friction = Parameter::parse("friction=uniform(0.3,1.2)", &experiment.unwrap()).unwrap();
        assert_eq!(
            friction.settings("0.5", &[]).unwrap(),
            [
                "sim.feeler.static_friction=0.5",
                "sim.feeler.kinetic_friction=0.30637254901960786"
            ]
        );
    }

    fn entry(toml: &str) -> Entry {
        toml::from_str(&format!("name = \"x\"\ngroup = \"g\"\nwhy = \"w\"\n{toml}")).unwrap()
    }

    #[test]
    fn an_entry_scales_its_keys_by_their_factors() {
        let mirrored = entry(
            r#"
            keys = [{ key = "screw.finger.0.home.0" }, { key = "screw.finger.1.home.0", factor = -1.0 }]
            range = "shifted(-0.001, 0.001)""#,
        );
        let parameter = Parameter::of_entry(&mirrored, &reference()).unwrap();
        assert_eq!(
            parameter.settings("-0.04", &[]).unwrap(),
            [
                "task.screw.finger.0.home.0=-0.04",
                "task.screw.finger.1.home.0=0.04"
            ]
        );
        let home: f64 = parameter.nominal.parse().unwrap();
        assert_eq!(
            parameter.distribution,
            Distribution::Uniform(home - 0.001, home + 0.001)
        );
        let unlike = entry(
            r#"
            keys = [{ key = "screw.finger.0.home.0" }, { key = "screw.finger.1.home.0" }]
            range = "relative(0.9, 1.1)""#,
        );
        let error = Parameter::of_entry(&unlike, &reference()).unwrap_err();
        assert!(
            error.to_string().contains("expected equal values"),
            "{error}"
        );
    }

    #[test]
    fn a_relative_value_follows_its_reference() {
        let kinetic = entry(
            r#"
            key = "sim.feeler.kinetic_friction"
            of = "sim.feeler.static_friction"
            range = "uniform(0.5, 1.0)""#,
        );
        let kinetic = Parameter::of_entry(&kinetic, &reference()).unwrap();
        let set = ["sim.feeler.static_friction=0.8".to_string()];
        assert_eq!(
            kinetic.settings("0.5", &set).unwrap(),
            ["sim.feeler.kinetic_friction=0.4"]
        );
        let experiment = reference().config.sim.expect("a simulated rig").feeler;
        let ratio: f64 = kinetic.nominal.parse().unwrap();
        let nominal = kinetic.settings(&kinetic.nominal, &[]).unwrap();
        let value: f64 = nominal[0].split_once('=').unwrap().1.parse().unwrap();
        assert!((value - experiment.kinetic_friction).abs() < 1e-12 && ratio < 1.0);
    }
}
