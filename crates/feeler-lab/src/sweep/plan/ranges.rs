//! Files of ranges: plausible ranges of uncertain values of an experiment, with justifications.

use crate::config::ConfigError;
use crate::sweep::SweepError;
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::Path;

/// Built-in ranges by experiment name.
const BUILT_IN: [(&str, &str); 1] = [(
    "cap-closing",
    include_str!("../../../experiments/cap-closing.robustness.toml"),
)];

/// One varied parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// Name of the parameter; also the name of its column.
    pub name: String,
    /// Group of the parameter by its origin, such as `apparatus` (materials and manufacturing) or `tuning` (chosen by
    /// an engineer).
    pub group: String,
    /// Unit of the range; empty for ratios.
    #[serde(default)]
    pub unit: String,
    /// The key to set, if there is only one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub key: Option<String>,
    /// The keys to set together, if there are several.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub keys: Vec<Link>,
    /// Key whose value scales the drawn value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub of: Option<String>,
    /// Exponent of the value of key `of`. Each key is set to the drawn value times its factor times that value raised
    /// to `power`. Default: 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub power: Option<f64>,
    /// Distribution, such as `log_uniform(250, 1500)`.
    pub range: String,
    /// Justification of the range.
    pub why: String,
}

/// A key that is set to a multiple of the drawn value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Link {
    /// Key in the experiment file.
    pub key: String,
    /// Factor of the drawn value.
    #[serde(default = "one")]
    pub factor: f64,
}

fn one() -> f64 {
    1.0
}

impl Entry {
    /// Returns the keys to set with their factors.
    ///
    /// # Errors
    /// If neither or both of `key` and `keys` are given, or a factor is 0 or not finite.
    pub fn links(&self) -> Result<Vec<(String, f64)>, String> {
        match (&self.key, &self.keys[..]) {
            (Some(key), []) => Ok(vec![(key.clone(), 1.0)]),
            (None, [_, ..]) => (self.keys.iter())
                .map(|link| match link.factor.is_finite() && link.factor != 0.0 {
                    true => Ok((link.key.clone(), link.factor)),
                    false => Err(format!(
                        "factor {}: expected a number other than 0",
                        link.factor
                    )),
                })
                .collect(),
            _ => Err("expected either key or keys".to_string()),
        }
    }
}

/// Content of a file of ranges.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ranges {
    /// Settings (`KEY=VALUE`) applied to the experiment before any variation, mainly to add tables that it lacks but
    /// that contain varied values.
    #[serde(default)]
    pub set: Vec<String>,
    /// Varied parameters.
    pub parameter: Vec<Entry>,
}

/// Loads and concatenates the given files of ranges, or the built-in ranges of `experiment` if there are no files.
///
/// # Errors
/// If there are no such ranges, or they are invalid.
pub fn load(files: &[impl AsRef<Path>], experiment: &str) -> Result<Ranges, SweepError> {
    if !files.is_empty() {
        let mut all = Ranges::default();
        for path in files.iter().map(AsRef::as_ref) {
            let note = "expected a file of ranges (TOML)";
            let text = fs::read_to_string(path).map_err(SweepError::file(path, note))?;
            let ranges = parse(&text, &path.display().to_string())?;
            all.set.extend(ranges.set);
            all.parameter.extend(ranges.parameter);
        }
        return Ok(all);
    }
    let built_in = BUILT_IN.iter().find(|(name, _)| *name == experiment);
    let (_, text) = built_in.ok_or_else(|| SweepError::Vary {
        said: "--ranges".to_string(),
        message: format!(
            "there are no built-in ranges for {experiment}, only for {}: expected a file of ranges",
            BUILT_IN.map(|(name, _)| name).join(", ")
        ),
    })?;
    parse(text, &format!("the ranges of {experiment}"))
}

fn parse(text: &str, origin: &str) -> Result<Ranges, SweepError> {
    let syntax = |message: String| ConfigError::Syntax {
        origin: origin.to_string(),
        message: message.trim_end().to_string(),
    };
    let file: Ranges = toml::from_str(text).map_err(|e| syntax(e.to_string()))?;
    for (index, entry) in file.parameter.iter().enumerate() {
        let texts = [&entry.name, &entry.group, &entry.why];
        if texts.iter().any(|text| text.trim().is_empty()) {
            let number = index + 1;
            return Err(syntax(format!(
                "parameter {number}: name, group and why must not be empty"
            ))
            .into());
        }
        if file.parameter[..index]
            .iter()
            .any(|other| other.name == entry.name)
        {
            return Err(syntax(format!("parameter {:?} occurs twice", entry.name)).into());
        }
        if entry.range.trim_start().starts_with("normal") {
            let name = &entry.name;
            return Err(syntax(format!(
                "parameter {name:?}: {} has no bounds; expected uniform, log_uniform, relative, shifted or choice",
                entry.range
            ))
            .into());
        }
    }
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Experiment;
    use crate::sweep::Plan;
    use crate::sweep::plan::design::Design;
    use crate::sweep::trial::Trials;

    #[test]
    fn built_in_ranges_contain_the_nominal_values() {
        for (name, _) in BUILT_IN {
            let files: [&Path; 0] = [];
            let ranges = load(&files, name).unwrap();
            let experiment = Experiment::load(name, &ranges.set).unwrap();
            let design = Design {
                rows: 2,
                controls: 0,
                pairs: 1,
            };
            let plan = Plan::designed(&experiment, name, ranges.parameter, design, 0).unwrap();
            let (_, parameters) = plan.load().unwrap();
            for parameter in parameters {
                let ends = parameter.distribution.extremes(parameter.whole);
                let number = |text: &String| text.parse::<f64>().unwrap();
                let (low, high) = (number(&ends[0]), number(&ends[1]));
                let nominal = number(&parameter.nominal);
                assert!((low..=high).contains(&nominal), "{parameter:?}");
            }
        }
    }

    /// The elements of every hand withstand the force that their stiffness allows, and no law rejects a hand for it.
    #[test]
    fn f2_scales_with_the_root_of_the_stiffness_under_any_law() {
        for law in ["tri-axial", "best"] {
            let files: [&Path; 0] = [];
            let ranges = load(&files, "cap-closing").unwrap();
            let setting = format!("control.law={law}");
            let experiment = Experiment::load("cap-closing", &[setting]).unwrap();
            let design = Design {
                rows: 32,
                controls: 0,
                pairs: 0,
            };
            let plan = Plan::designed(&experiment, "", ranges.parameter, design, 0).unwrap();
            let trials = Trials::new(&plan).unwrap();
            let mut softest = f64::INFINITY;
            for trial in 0..32 {
                let config = trials.experiment(trial).unwrap().config;
                let stiffness = config.simulation().unwrap().feeler.normal_stiffness;
                let rated = 0.505 * (stiffness / 205.0).sqrt();
                let to_rated = config.control.over_force / rated;
                assert!((0.899..1.101).contains(&to_rated), "{to_rated}");
                softest = softest.min(config.control.over_force);
            }
            assert!(softest < 0.45, "below the force of best: {softest}");
        }
    }

    #[test]
    fn invalid_ranges_are_rejected() {
        let entry = |more: &str| {
            format!("[[parameter]]\nname = \"a\"\ngroup = \"g\"\nwhy = \"w\"\n{more}\n")
        };
        let good = entry("key = \"k\"\nrange = \"uniform(0,1)\"");
        assert_eq!(
            parse(&good, "").unwrap().parameter[0].links().unwrap(),
            [("k".to_string(), 1.0)]
        );
        for (text, word) in [
            (String::new(), "parameter"),
            (entry("key = \"k\""), "range"),
            (entry("key = \"k\"\nrange = \"normal(0,1)\""), "no bounds"),
            (good.replace("\"w\"", "\" \""), "must not be empty"),
            (format!("{good}{good}"), "twice"),
            (format!("{good}what = 1"), "what"),
        ] {
            let error = parse(&text, "file").unwrap_err().to_string();
            assert!(
                error.contains("file") && error.contains(word),
                "{text}: {error}"
            );
        }
        let links = |more: &str| {
            parse(&entry(more), "").unwrap().parameter[0]
                .links()
                .unwrap_err()
        };
        assert!(links("range = \"uniform(0,1)\"").contains("either"));
        assert!(
            links("range = \"uniform(0,1)\"\nkeys = [{ key = \"k\", factor = 0.0 }]")
                .contains("other than 0")
        );
    }
}
