//! Laws to compare, and their names.

use super::arguments::PAGE;
use crate::CommandError;
use feeler::control::law::LawConfig;
use feeler::control::law::policy::PolicyConfig;
use std::path::{Path, PathBuf};

/// Maximum number of laws and policies, for distinguishable curves.
const MAX_LAWS: usize = 10;

/// Returns the requested laws and policies with their names.
pub fn laws(
    names: &[String],
    policies: &[PathBuf],
) -> Result<Vec<(String, LawConfig)>, CommandError> {
    let mut laws: Vec<(String, LawConfig)> = Vec::new();
    for name in names.iter().map(|name| name.trim()) {
        let law = LawConfig::named(name).ok_or_else(|| {
            let names = LawConfig::NAMES.join(", ");
            format!("--laws: unknown control law {name:?}; expected some of {names}")
        })?;
        if laws.iter().any(|(other, _)| other == name) {
            return Err(format!("--laws: {name} is given twice").into());
        }
        laws.push((name.to_string(), law));
    }
    for file in policies {
        let policy = policy(file)?;
        if laws.iter().any(|(other, _)| *other == policy.0) {
            let (file, name) = (file.display(), policy.0);
            let message = format!("the name {name} is already taken; rename the file");
            return Err(format!("--policy {file}: {message}").into());
        }
        laws.push(policy);
    }
    if laws.len() > MAX_LAWS {
        let count = laws.len();
        return Err(format!("expected at most {MAX_LAWS} laws and policies, got {count}").into());
    }
    Ok(laws)
}

/// Returns the policy in `file`, named after the file.
fn policy(file: &Path) -> Result<(String, LawConfig), CommandError> {
    let wrong = |message: &str| format!("--policy {}: {message}", file.display());
    // The name is used for a folder next to the report, and in commands.
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    let good = |stem: &&str| stem.chars().all(plain) && !stem.starts_with('.') && *stem != PAGE;
    let stem = file.file_stem().and_then(|stem| stem.to_str());
    let expected = "expected a file named by letters, digits, dots, hyphens and underscores";
    let name = stem
        .filter(good)
        .ok_or_else(|| wrong(expected))?
        .to_string();
    // Absolute, so that the path does not depend on the experiment's folder.
    let path = file.canonicalize();
    let path = path.map_err(|e| wrong(&format!("{e}; expected a policy file")))?;
    let path = path.to_str();
    let path = path.ok_or_else(|| wrong("expected a path in UTF-8"))?;
    let policy = PolicyConfig {
        file: path.to_string(),
        model: None,
    };
    Ok((name, LawConfig::Policy(policy)))
}
