//! The `feeler certificates` subcommand: a lab's certificate authority, and certificates for its computers.

#![cfg_attr(
    not(feature = "link"),
    allow(dead_code, reason = "this program has no link")
)]

use crate::{CommandError, Outcome};
use feeler_link::security::{Right, RightError};
use std::io::Write;
use std::path::PathBuf;
use std::str::FromStr;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Folder of the lab's authority; created if missing. Keep it private.
    lab: PathBuf,
    /// Computers by name or address, each with its rights, e.g. 10.0.0.5=hand,rig,order [default: all rights]
    ///
    /// Rights: hand, rig, sense-0 to sense-4, order (stop and resume), stop, watch. Copy LAB/COMPUTER to each
    /// computer and pass it to programs there with --certificates.
    #[arg(value_name = "COMPUTER[=RIGHTS]", required_unless_present = "list")]
    computers: Vec<Grant>,
    /// Validity of the certificates (days) [default: 365]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=3650))]
    days: Option<u32>,
    /// Issue existing certificates again. The old ones remain valid unless --withdraw is given too.
    #[arg(long)]
    renew: bool,
    /// Withdraw (revoke) existing certificates.
    ///
    /// LAB/withdrawn.txt lists them. Copy it into the hand's certificate folder and restart the hand.
    #[arg(long)]
    withdraw: bool,
    /// List the lab's certificates.
    #[arg(long, conflicts_with_all = ["computers", "days", "renew", "withdraw"])]
    list: bool,
}

/// A computer and its rights.
#[derive(Debug, Clone, PartialEq)]
struct Grant {
    computer: String,
    /// The named rights, or `None` for all.
    rights: Option<Vec<Right>>,
}

impl FromStr for Grant {
    type Err = RightError;

    fn from_str(text: &str) -> Result<Self, RightError> {
        let Some((computer, rights)) = text.split_once('=') else {
            let (computer, rights) = (text.into(), None);
            return Ok(Self { computer, rights });
        };
        let mut given = rights
            .split(',')
            .map(str::parse)
            .collect::<Result<Vec<Right>, _>>()?;
        given.sort();
        given.dedup();
        let (computer, rights) = (computer.into(), Some(given));
        Ok(Self { computer, rights })
    }
}

impl Grant {
    /// Returns the named rights, or all.
    fn rights(&self) -> Vec<Right> {
        self.rights.clone().unwrap_or_else(Right::all)
    }
}

/// Issues, renews, revokes or lists certificates.
#[cfg(feature = "link")]
pub fn certificates(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    use feeler_link::security::Authority;
    if arguments.list {
        list(&Authority::open(&arguments.lab)?, out)?;
        return Ok(Outcome::Done);
    }
    if arguments.withdraw && arguments.days.is_some() && !arguments.renew {
        return Err("--days has no effect with --withdraw; add --renew".into());
    }
    if arguments.renew || arguments.withdraw {
        let mut authority = Authority::open(&arguments.lab)?;
        for grant in &arguments.computers {
            replace(&mut authority, grant, arguments, out)?;
        }
        return Ok(Outcome::Done);
    }
    let mut authority = Authority::open_or_make(&arguments.lab)?;
    for grant in &arguments.computers {
        make(&mut authority, grant, arguments, out)?;
    }
    Ok(Outcome::Done)
}

#[cfg(feature = "link")]
fn make(
    authority: &mut feeler_link::security::Authority,
    grant: &Grant,
    arguments: &Arguments,
    out: &mut dyn Write,
) -> Result<(), CommandError> {
    let validity = arguments.validity();
    let names = authority.certify(&grant.computer, &grant.rights(), validity)?;
    write!(out, "{}", made(authority, grant, &names, validity)?)?;
    match grant.rights {
        Some(_) => writeln!(out)?,
        None => writeln!(out, "; all rights, because none were given")?,
    }
    Ok(())
}

/// Describes the location and validity of the certificates `names`.
#[cfg(feature = "link")]
fn made(
    authority: &feeler_link::security::Authority,
    grant: &Grant,
    names: &[feeler_link::security::CertificateName],
    validity: feeler_link::security::Validity,
) -> Result<String, CommandError> {
    let folder = authority.folder(&grant.computer)?;
    let (folder, until) = (folder.display(), validity.last_day());
    Ok(format!("{folder}: {}, valid until {until}", listed(names)))
}

/// Revokes or renews certificates, or both.
#[cfg(feature = "link")]
fn replace(
    authority: &mut feeler_link::security::Authority,
    grant: &Grant,
    arguments: &Arguments,
    out: &mut dyn Write,
) -> Result<(), CommandError> {
    let (computer, rights) = (&grant.computer, grant.rights());
    let old = authority.names(computer, &rights);
    if arguments.renew {
        let validity = arguments.validity();
        let names = authority.renew(computer, &rights, validity)?;
        writeln!(out, "{}", made(authority, grant, &names, validity)?)?;
        if !arguments.withdraw {
            let old = listed(&old);
            writeln!(out, "not withdrawn, valid until they expire: {old}")?;
        }
    }
    if arguments.withdraw {
        if old.is_empty() {
            // Fails with a message that lists the existing certificates.
            authority.withdraw(computer, &rights)?;
        }
        authority.withdraw_names(&old)?;
        let list = arguments.lab.join(feeler_link::security::WITHDRAWN);
        let (old, list) = (listed(&old), list.display());
        writeln!(
            out,
            "withdrawn: {old}; copy {list} into the certificate folder of the hand and restart the hand"
        )?;
    }
    Ok(())
}

#[cfg(feature = "link")]
impl Arguments {
    fn validity(&self) -> feeler_link::security::Validity {
        use feeler_link::security::{DAYS, Validity};
        Validity::days(self.days.unwrap_or(DAYS))
    }
}

#[cfg(feature = "link")]
fn listed(names: &[feeler_link::security::CertificateName]) -> String {
    let names: Vec<String> = names.iter().map(ToString::to_string).collect();
    names.join(", ")
}

#[cfg(feature = "link")]
fn list(
    authority: &feeler_link::security::Authority,
    out: &mut dyn Write,
) -> Result<(), CommandError> {
    writeln!(
        out,
        "{:<24} {:<8} {:>6}  {:<10}  state",
        "computer", "right", "serial", "until"
    )?;
    for listed in authority.list()? {
        let (entry, mut states) = (&listed.entry, Vec::new());
        let all = [
            (listed.withdrawn, "withdrawn"),
            (listed.expired, "expired"),
            (listed.replaced, "replaced"),
        ];
        states.extend(all.iter().filter(|(is, _)| *is).map(|(_, word)| *word));
        let state = match states.is_empty() {
            true => "valid".into(),
            false => states.join(", "),
        };
        let (computer, until) = (&entry.computer, &entry.until);
        let (right, serial) = (entry.name.right.to_string(), entry.name.serial);
        writeln!(
            out,
            "{computer:<24} {right:<8} {serial:>6}  {until:<10}  {state}"
        )?;
    }
    Ok(())
}

/// Returns an error: this build has no link.
#[cfg(not(feature = "link"))]
pub fn certificates(arguments: &Arguments, _: &mut dyn Write) -> Result<Outcome, CommandError> {
    let computers: Vec<String> = arguments
        .computers
        .iter()
        .map(|grant| format!("{} ({} rights)", grant.computer, grant.rights().len()))
        .collect();
    let (lab, computers) = (arguments.lab.display(), computers.join(", "));
    Err(format!("{lab}: no certificates for {computers}: this program was built without the link; build it with --features link").into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grant_names_rights_or_gives_all() {
        let some: Grant = "10.0.0.6=sense-1,sense-0,sense-1".parse().unwrap();
        assert_eq!(some.computer, "10.0.0.6");
        assert_eq!(some.rights(), [Right::Sense(0), Right::Sense(1)]);
        let all: Grant = "console".parse().unwrap();
        assert_eq!(all.rights(), Right::all());
        for wrong in ["console=", "console=watch,", "console=sense"] {
            let error = wrong.parse::<Grant>().unwrap_err().to_string();
            assert!(error.contains("expected hand, rig"), "{error}");
        }
    }
}
