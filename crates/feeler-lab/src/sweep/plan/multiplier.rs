//! Scaling of a drawn value by a power of another value of the experiment.

use super::ranges::Entry;
use crate::config::key::{find, number};
use toml::Value;

/// A factor given by the value of a key, raised to a power.
#[derive(Debug, Clone, PartialEq)]
pub struct Multiplier {
    /// Key whose value is the base of the power.
    pub key: String,
    power: f64,
    /// Value of the key in the experiment.
    nominal: f64,
}

impl Multiplier {
    /// Returns the multiplier of `entry`, whose key is looked up in the experiment's `leaves`. `None` if the entry does
    /// not contain `of`.
    ///
    /// # Errors
    /// If the key is unknown, its value is 0 or not a number, a power is given without a key, the power is 0 or not
    /// finite, or a negative value would be raised to a power other than 1.
    pub fn of_entry(entry: &Entry, leaves: &[(String, Value)]) -> Result<Option<Self>, String> {
        let power = entry.power.unwrap_or(1.0);
        if !power.is_finite() || power == 0.0 {
            return Err(format!("power = {power}: expected a number other than 0"));
        }
        let Some(name) = &entry.of else {
            return match entry.power {
                None => Ok(None),
                Some(_) => Err(format!(
                    "power = {power}: a power requires a key; add of = KEY"
                )),
            };
        };
        let (key, value) = find(name, leaves)?;
        let nominal = number(value).filter(|value| *value != 0.0);
        let nominal = nominal.ok_or(format!("{key} is 0 or not a number"))?;
        if power != 1.0 && nominal < 0.0 {
            return Err(format!(
                "{key} is {nominal}, which has no power of {power}: expected a number above 0"
            ));
        }
        Ok(Some(Self {
            key: key.clone(),
            power,
            nominal,
        }))
    }

    /// Returns the factor for the unmodified experiment.
    pub fn nominal(&self) -> f64 {
        self.raised(self.nominal)
    }

    /// Returns the factor with the settings `earlier` (`KEY=VALUE`) applied; the last setting of the key wins.
    pub fn after(&self, earlier: &[String]) -> f64 {
        let set = earlier.iter().rev().find_map(|setting| {
            let (key, value) = setting.split_once('=')?;
            value.parse().ok().filter(|_| key == self.key)
        });
        self.raised(set.unwrap_or(self.nominal))
    }

    fn raised(&self, value: f64) -> f64 {
        match self.power == 1.0 {
            true => value,
            false => libm::pow(value, self.power),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn multiplier(toml: &str) -> Result<Option<Multiplier>, String> {
        let entry = format!(
            "name = \"x\"\ngroup = \"g\"\nwhy = \"w\"\nkey = \"k\"\nrange = \"uniform(0,1)\"\n{toml}"
        );
        let leaves = [("a.stiffness", 16.0), ("a.zero", 0.0), ("a.below", -4.0)];
        let leaves = leaves.map(|(key, value)| (key.to_string(), Value::Float(value)));
        Multiplier::of_entry(&toml::from_str(&entry).unwrap(), &leaves)
    }

    #[test]
    fn the_last_setting_wins_and_is_raised_to_the_power() {
        let root = multiplier("of = \"stiffness\"\npower = 0.5")
            .unwrap()
            .unwrap();
        assert_eq!(root.nominal(), 4.0);
        let set = ["a.stiffness=9.0", "b.stiffness=1.0", "a.stiffness=25.0"].map(String::from);
        assert_eq!(root.after(&set), 5.0);
        assert_eq!(root.after(&set[1..2]), 4.0);
        let plain = multiplier("of = \"below\"").unwrap().unwrap();
        assert_eq!(plain.nominal(), -4.0);
        assert_eq!(multiplier("").unwrap(), None);
    }

    #[test]
    fn an_invalid_power_is_rejected() {
        for (toml, words) in [
            ("power = 0.5", "add of = KEY"),
            ("of = \"stiffness\"\npower = 0.0", "other than 0"),
            ("of = \"stiffness\"\npower = nan", "other than 0"),
            ("of = \"below\"\npower = 0.5", "above 0"),
            ("of = \"zero\"\npower = 0.5", "0 or not a number"),
            ("of = \"stifness\"", "a.stiffness"),
        ] {
            let error = multiplier(toml).unwrap_err();
            assert!(error.contains(words), "{toml}: {error}");
        }
    }
}
