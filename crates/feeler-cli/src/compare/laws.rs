//! The laws that are compared, and what they are called.

use super::PAGE;
use crate::CommandError;
use feeler::control::law::LawConfig;
use feeler::control::law::policy::PolicyConfig;
use std::path::{Path, PathBuf};

/// Most laws and policies whose curves can be told apart.
const MOST_LAWS: usize = 10;

/// The laws and policies that were asked for, by name.
pub fn laws(
    names: &[String],
    policies: &[PathBuf],
) -> Result<Vec<(String, LawConfig)>, CommandError> {
    let mut laws: Vec<(String, LawConfig)> = Vec::new();
    for name in names.iter().map(|name| name.trim()) {
        let law = LawConfig::named(name).ok_or_else(|| {
            let names = LawConfig::NAMES.join(", ");
            format!("--laws: there is no control law {name:?}; expected some of {names}")
        })?;
        if laws.iter().any(|(other, _)| other == name) {
            return Err(format!("--laws: {name} is there twice").into());
        }
        laws.push((name.to_string(), law));
    }
    for file in policies {
        let policy = policy(file)?;
        if laws.iter().any(|(other, _)| *other == policy.0) {
            let (file, name) = (file.display(), policy.0);
            let message = format!("there is a {name} already; expected a file of another name");
            return Err(format!("--policy {file}: {message}").into());
        }
        laws.push(policy);
    }
    if laws.len() > MOST_LAWS {
        let count = laws.len();
        return Err(format!(
            "{count} laws and policies; expected at most {MOST_LAWS} in one figure"
        )
        .into());
    }
    Ok(laws)
}

/// The policy in `file`, called by that.
fn policy(file: &Path) -> Result<(String, LawConfig), CommandError> {
    let wrong = |message: &str| format!("--policy {}: {message}", file.display());
    // It names a folder beside the page, and is part of commands.
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    let good = |stem: &&str| stem.chars().all(plain) && !stem.starts_with('.') && *stem != PAGE;
    let stem = file.file_stem().and_then(|stem| stem.to_str());
    let expected = "expected a file named by letters, digits, dots, hyphens and underscores";
    let name = stem
        .filter(good)
        .ok_or_else(|| wrong(expected))?
        .to_string();
    // Whatever folder the experiment is in.
    let path = file.canonicalize();
    let path = path.map_err(|e| wrong(&format!("{e}; expected the file of a policy")))?;
    let path = path.to_str();
    let path = path.ok_or_else(|| wrong("expected a path in UTF-8"))?;
    let policy = PolicyConfig {
        file: path.to_string(),
        model: None,
    };
    Ok((name, LawConfig::Policy(policy)))
}
