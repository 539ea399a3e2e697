//! Lists and revokes the certificates of a lab.

use super::authority::{Authority, CertificateError, none};
use super::files::{FileError, append};
use super::register::Entry;
use super::right::{CertificateName, Right};
use super::validity;
use super::withdrawn::{self, WITHDRAWN};
use std::collections::BTreeSet;
use std::fs;

/// Certificate issued by the lab, with its status.
#[derive(Debug, Clone, PartialEq)]
pub struct Listed {
    /// Name, computer and last day of validity.
    pub entry: Entry,
    /// `true` if the lab has revoked the certificate.
    pub withdrawn: bool,
    /// `true` if the last day of validity is over.
    pub expired: bool,
    /// `true` if the computer has a newer certificate for the same right.
    pub replaced: bool,
}

impl Authority {
    /// Revokes all certificates of `computer` that grant one of `rights`, and returns their names. Updates the list of
    /// revoked certificates in the lab's folder and in each computer's folder.
    ///
    /// # Errors
    /// If the computer has no such certificate, or the list cannot be read or written.
    pub fn withdraw(
        &self,
        computer: &str,
        rights: &[Right],
    ) -> Result<Vec<CertificateName>, CertificateError> {
        let entries = self.register.of(computer, rights);
        let names: Vec<_> = entries.map(|entry| entry.name).collect();
        if names.is_empty() {
            return Err(none(computer, rights));
        }
        self.withdraw_names(&names)?;
        Ok(names)
    }

    /// Returns the names of all certificates of `computer` that grant one of `rights`.
    pub fn names(&self, computer: &str, rights: &[Right]) -> Vec<CertificateName> {
        let entries = self.register.of(computer, rights);
        entries.map(|entry| entry.name).collect()
    }

    /// Revokes the named certificates.
    ///
    /// # Errors
    /// If the list cannot be read or written.
    pub fn withdraw_names(&self, names: &[CertificateName]) -> Result<(), CertificateError> {
        let path = self.lab.join(WITHDRAWN);
        let already = withdrawn::read(&path)?;
        let today = validity::day(validity::now());
        let entries = self.register.entries().iter();
        let new = entries.filter(|e| names.contains(&e.name) && !already.contains(&e.name));
        let lines = new.map(|e| format!("{} {} withdrawn {today}\n", e.name, e.computer));
        let lines: String = lines.collect();
        append(&path, &lines)?;
        self.hand_out_withdrawn()
    }

    /// Returns all certificates, in the order in which they were issued.
    ///
    /// # Errors
    /// If the list of revoked certificates cannot be read.
    pub fn list(&self) -> Result<Vec<Listed>, CertificateError> {
        let withdrawn = withdrawn::read(&self.lab.join(WITHDRAWN))?;
        let today = validity::day(validity::now());
        let newest = |entry: &Entry| {
            let right = [entry.name.right];
            let alike = self.register.of(&entry.computer, &right);
            alike.map(|e| e.name.serial).max()
        };
        let listed = |entry: &Entry| Listed {
            withdrawn: withdrawn.contains(&entry.name),
            expired: entry.until < today,
            replaced: newest(entry) > Some(entry.name.serial),
            entry: entry.clone(),
        };
        Ok(self.register.entries().iter().map(listed).collect())
    }

    /// Copies the list of revoked certificates into the folder of each computer.
    pub(crate) fn hand_out_withdrawn(&self) -> Result<(), CertificateError> {
        let list = self.lab.join(WITHDRAWN);
        if !list.exists() {
            return Ok(());
        }
        let entries = self.register.entries().iter();
        let computers: BTreeSet<&str> = entries.map(|e| e.computer.as_str()).collect();
        for computer in computers {
            let folder = self.folder(computer)?;
            if folder.is_dir() {
                let copy = folder.join(WITHDRAWN);
                fs::copy(&list, &copy).map_err(FileError::at(&copy))?;
            }
        }
        Ok(())
    }
}
