//! What varies, and the keys of the experiment that it sets: `--vary NAME=DISTRIBUTION`, or an entry of a
//! file of ranges ([`Entry`]), which can link several keys.

use super::SweepError;
use super::distribution::{Distribution, number_text};
use super::multiplier::Multiplier;
use super::ranges::Entry;
use crate::config::Experiment;
use crate::config::key::{FRICTION, find, leaves, number};
use feeler::control::law::LawConfig;
use toml::Value;

/// Largest relative difference of two linked values that are called equal: what 12 digits leave.
const SAME: f64 = 1e-12;

/// A varied parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// As it was called; also the name of its column.
    pub name: String,
    /// What it is drawn from.
    pub distribution: Distribution,
    /// Whether it takes whole numbers only.
    pub whole: bool,
    /// The value that the experiment has, as text.
    pub nominal: String,
    /// How it was asked for, for messages.
    said: String,
    /// The keys that it sets, each to the value times a factor.
    keys: Vec<(String, f64)>,
    /// What multiplies them all.
    of: Option<Multiplier>,
}

impl Parameter {
    /// Reads `NAME=DISTRIBUTION` for an experiment, and checks that its bounds are in range.
    ///
    /// # Errors
    /// When it does not parse, names no parameter or more than one, or is out of range.
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
        // The static friction of all feelers and objects, the kinetic in proportion.
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

    /// The parameter that an entry of a file of ranges means. Its bounds are checked with all others
    /// ([`check_together`]), as some make sense together only.
    ///
    /// # Errors
    /// When it names no keys, they are not in the proportion of their factors, or its range makes no sense.
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
                // As it is, so that a whole number stays one and nothing is rounded.
                _ if scale(factor) == 1.0 => value.clone(),
                Some(number) => Value::Float(number / scale(factor)),
                None => return Err(format!("{key} is no number and cannot be multiplied")),
            };
            match &nominal {
                None => nominal = Some(own),
                Some(first) if same(first, &own) => {}
                Some(first) => {
                    return Err(format!(
                        "the experiment has {first} for the first key and {own} for {key}; expected the same, factors taken out"
                    ));
                }
            }
        }
        let nominal = nominal.ok_or("it sets no key")?;
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
            return Err(format!("{name} is no number: expected choice(a,b,…)"));
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

    /// A key that both set, or that the other multiplies by though it is set only later.
    pub fn conflict(&self, later: &Self) -> Option<String> {
        let sets = |key: &str| later.keys.iter().any(|(other, _)| other == key);
        let both = self.keys.iter().find(|(key, _)| sets(key));
        let both = both.map(|_| format!("varies what {} varies already", self.name));
        both.or_else(|| {
            let Multiplier { key, .. } = self.of.as_ref().filter(|of| sets(&of.key))?;
            let name = &self.name;
            Some(format!(
                "varies {key}, by which {name} is multiplied: expected it before that"
            ))
        })
    }

    /// Whether it sets this key of the experiment.
    pub fn sets(&self, key: &str) -> bool {
        self.keys.iter().any(|(own, _)| own == key)
    }

    /// That something is wrong with it.
    pub fn error(&self, message: String) -> SweepError {
        let said = self.said.clone();
        SweepError::Vary { said, message }
    }

    /// The settings that give it the value that this text says, after `earlier` ones.
    fn settings(&self, value: &str, earlier: &[String]) -> Result<Vec<String>, SweepError> {
        let of = self.of.as_ref().map_or(1.0, |of| of.after(earlier));
        let keys = self.keys.iter().map(|(key, factor)| {
            let factor = factor * of;
            if factor == 1.0 {
                return Ok(format!("{key}={value}"));
            }
            let number: Result<f64, _> = value.parse();
            let number =
                number.map_err(|_| self.error(format!("{value:?} is no number to multiply")))?;
            Ok(format!("{key}={}", number_text(factor * number, false)))
        });
        keys.collect()
    }
}

/// The settings that give each parameter its value, in their order.
///
/// # Errors
/// When a value is no number where one is needed.
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

/// Requires that no parameter sets what another one sets, or is multiplied by it before it is set.
///
/// # Errors
/// The first that does.
pub fn check_conflicts(parameters: &[Parameter]) -> Result<(), SweepError> {
    for (index, parameter) in parameters.iter().enumerate() {
        let mut earlier = parameters[..index].iter();
        if let Some(conflict) = earlier.find_map(|other| other.conflict(parameter)) {
            return Err(parameter.error(conflict));
        }
    }
    Ok(())
}

/// Checks both ends of each parameter's range while all others are as the experiment has them.
///
/// # Errors
/// The first that is out of range.
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

/// The keys of static and kinetic friction: the kinetic by static as the experiment has it.
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
    fn friction_keeps_its_proportion() {
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
    fn an_entry_sets_its_keys_by_their_factors() {
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
        assert!(error.to_string().contains("expected the same"), "{error}");
    }

    #[test]
    fn what_is_relative_to_another_follows_it() {
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
