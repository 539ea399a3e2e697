//! Distributions of parameters, such as `uniform(0.3,1.2)`.

use rand::RngExt;
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;

/// Distribution of a parameter.
#[derive(Debug, Clone, PartialEq)]
pub enum Distribution {
    /// Uniform between two bounds.
    Uniform(f64, f64),
    /// Normal: mean and standard deviation.
    Normal(f64, f64),
    /// Log-uniform between two bounds.
    LogUniform(f64, f64),
    /// One of these values with equal probability; TOML values or words.
    Choice(Vec<String>),
}

/// Valid forms, for error messages.
const EXPECTED: &str = "expected uniform(a,b), normal(mean,sd), log_uniform(a,b), relative(a,b), shifted(a,b), \
                        choice(a,b,…) or a value";

impl Distribution {
    /// Parses a distribution. `relative(a,b)` is uniform from `a` to `b` times the experiment's value `nominal`;
    /// `shifted(a,b)` is uniform from `nominal + a` to `nominal + b`.
    ///
    /// # Errors
    /// If the text is not a valid distribution, a message that describes the problem.
    pub fn parse(text: &str, nominal: Option<f64>) -> Result<Self, String> {
        let text = text.trim();
        let Some((name, rest)) = text.split_once('(') else {
            let plain = !text.is_empty() && !text.contains([')', ',']);
            return plain
                .then(|| Self::Choice(vec![text.to_string()]))
                .ok_or_else(|| format!("{text:?} is not a distribution: {EXPECTED}"));
        };
        let inside = (rest.strip_suffix(')'))
            .ok_or_else(|| format!("{text:?} does not end with a bracket: {EXPECTED}"))?;
        let arguments: Vec<&str> = inside.split(',').map(str::trim).collect();
        let two = || two_numbers(name, &arguments);
        match name.trim() {
            "uniform" => match two()? {
                (a, b) if a <= b => Ok(Self::Uniform(a, b)),
                (a, b) => Err(format!(
                    "uniform({a},{b}): the first must not exceed the second"
                )),
            },
            "relative" | "shifted" => {
                let (ends, about) = (
                    two()?,
                    nominal.ok_or(format!("{name} applies only to numbers"))?,
                );
                about_nominal(name, ends, about)
            }
            "log_uniform" => match two()? {
                (a, b) if a > 0.0 && a <= b => Ok(Self::LogUniform(a, b)),
                (a, b) => Err(format!(
                    "log_uniform({a},{b}): expected two numbers above 0, the first not above the second"
                )),
            },
            "normal" => match two()? {
                (mean, sd) if sd >= 0.0 => Ok(Self::Normal(mean, sd)),
                (_, sd) => Err(format!(
                    "normal: the standard deviation must not be negative, got {sd}"
                )),
            },
            "choice" if arguments.iter().all(|a| !a.is_empty()) => {
                let choices = arguments.iter().map(|&a| a.to_string());
                Ok(Self::Choice(choices.collect()))
            }
            "choice" => Err("choice: one of its values is empty".to_string()),
            other => Err(format!("unknown distribution {other:?}: {EXPECTED}")),
        }
    }

    /// Draws a value, as text for a setting. `whole` rounds it to an integer.
    pub fn draw(&self, random: &mut Pcg64, whole: bool) -> String {
        match self {
            Self::Normal(mean, sd) => {
                number_text(mean + sd * random.sample::<f64, _>(StandardNormal), whole)
            }
            bounded => bounded.quantile(random.random::<f64>(), whole),
        }
    }

    /// Returns the quantile at probability `p` (0 to 1), as text for a setting. For a normal distribution, which is
    /// unbounded and not allowed in files of ranges, returns the mean.
    pub fn quantile(&self, p: f64, whole: bool) -> String {
        let number = match self {
            Self::Uniform(a, b) => a + (b - a) * p,
            Self::Normal(mean, _) => *mean,
            Self::LogUniform(a, b) => libm::exp(libm::log(*a) + libm::log(b / a) * p).clamp(*a, *b),
            Self::Choice(choices) => {
                let index = (p * choices.len() as f64) as usize;
                return choices[index.min(choices.len() - 1)].clone();
            }
        };
        number_text(number, whole)
    }

    /// Returns values that are valid if the distribution is: its bounds, its mean or its choices.
    pub fn extremes(&self, whole: bool) -> Vec<String> {
        match self {
            Self::Uniform(a, b) | Self::LogUniform(a, b) => {
                vec![number_text(*a, whole), number_text(*b, whole)]
            }
            Self::Normal(mean, _) => vec![number_text(*mean, whole)],
            Self::Choice(choices) => choices.clone(),
        }
    }
}

/// Formats a number with all digits, so that it parses back to the same value.
pub fn number_text(number: f64, whole: bool) -> String {
    if whole {
        format!("{number:.0}")
    } else {
        format!("{number:?}")
    }
}

fn about_nominal(name: &str, (a, b): (f64, f64), nominal: f64) -> Result<Distribution, String> {
    if a > b {
        return Err(format!(
            "{name}({a},{b}): the first must not exceed the second"
        ));
    }
    if name == "shifted" {
        return Ok(Distribution::Uniform(nominal + a, nominal + b));
    }
    if nominal == 0.0 {
        return Err(format!(
            "relative({a},{b}): the experiment's value is 0; expected shifted(a,b)"
        ));
    }
    let (a, b) = (a * nominal, b * nominal);
    Ok(Distribution::Uniform(a.min(b), a.max(b)))
}

fn two_numbers(name: &str, arguments: &[&str]) -> Result<(f64, f64), String> {
    let [a, b] = arguments else {
        let count = arguments.len();
        return Err(format!("{name} takes 2 numbers, got {count}: {EXPECTED}"));
    };
    let number = |text: &str| match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err(format!("{name}: {text:?} is not a number: {EXPECTED}")),
    };
    Ok((number(a)?, number(b)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    #[test]
    fn draws_follow_the_distribution() {
        let mut random = Pcg64::seed_from_u64(1);
        let mut mean = |text: &str| {
            let distribution = Distribution::parse(text, Some(-2.0)).unwrap();
            let draw = |_| {
                distribution
                    .draw(&mut random, false)
                    .parse::<f64>()
                    .unwrap()
            };
            (0..20_000).map(draw).sum::<f64>() / 20_000.0
        };
        // Tolerance: four standard errors of each mean.
        assert!((mean("uniform(0.3, 1.2)") - 0.75).abs() < 0.008);
        assert!((mean("normal(2,0.5)") - 2.0).abs() < 0.015);
        assert!((mean("log_uniform(1,100)") - 99.0 / 100f64.ln()).abs() < 0.7);
        assert!((mean("choice(1,3)") - 2.0).abs() < 0.03);
        assert_eq!(mean("4.5"), 4.5);
        // Relative to the nominal value, -2.
        assert!((mean("relative(0.5,1)") + 1.5).abs() < 0.009);
        assert!((mean("shifted(0,1)") + 1.5).abs() < 0.009);
    }

    #[test]
    fn invalid_distributions_are_rejected() {
        for (text, word) in [
            ("", "expected uniform"),
            ("uniform(1,2", "bracket"),
            ("uniform(1)", "2 numbers"),
            ("uniform(2,1)", "must not exceed"),
            ("uniform(a,1)", "not a number"),
            ("uniform(nan,1)", "not a number"),
            ("log_uniform(0,1)", "above 0"),
            ("normal(0,-1)", "negative"),
            ("choice(1,,2)", "empty"),
            ("gamma(1,2)", "gamma"),
            ("relative(0.8,1.2)", "shifted"),
            ("shifted(1,0)", "must not exceed"),
        ] {
            let error = Distribution::parse(text, Some(0.0)).unwrap_err();
            assert!(error.contains(word), "{text:?}: {error}");
        }
    }
}
