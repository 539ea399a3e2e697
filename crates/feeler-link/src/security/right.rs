//! Rights of programs, and the certificate names that grant them.

use feeler::hand::MAX_FINGERS;
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Largest serial number of a certificate. It is bounded because a program's access rules list the names of all
/// certificates that it accepts.
pub const MAX_SERIAL: u32 = 999;

/// Right of a program, granted by its certificate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Right {
    /// Act as the hand.
    Hand,
    /// Act as the rig: encoders, drives and simulated cameras.
    Rig,
    /// Act as the sensor of the finger with this index.
    Sense(usize),
    /// Stop and resume the hand, and receive all messages.
    Order,
    /// Stop the hand.
    Stop,
    /// Receive all messages.
    Watch,
}

/// Error of parsing a right or a certificate name.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RightError {
    /// Unknown right.
    #[error(
        "unknown right {given:?}: expected hand, rig, sense-0 to sense-{}, order, stop or watch",
        MAX_FINGERS - 1
    )]
    Unknown {
        /// The unknown text.
        given: String,
    },
    /// Invalid certificate name.
    #[error(
        "invalid certificate name {given:?}: expected a right and a number from 1 to {MAX_SERIAL}, as in sense-0.17"
    )]
    Name {
        /// The invalid name.
        given: String,
    },
}

impl Right {
    /// Returns all rights.
    pub fn all() -> Vec<Self> {
        let mut rights = vec![Self::Hand, Self::Rig];
        rights.extend((0..MAX_FINGERS).map(Self::Sense));
        rights.extend([Self::Order, Self::Stop, Self::Watch]);
        rights
    }

    /// Returns the certificate folder of a program that needs any of `rights`: the first of `folder/RIGHT` that exists,
    /// otherwise `folder` itself.
    pub fn folder_in(folder: &Path, rights: &[Self]) -> PathBuf {
        let mut of_rights = rights.iter().map(|right| folder.join(right.to_string()));
        let first = of_rights.find(|path| path.is_dir());
        first.unwrap_or_else(|| folder.to_path_buf())
    }
}

impl fmt::Display for Right {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Hand => f.write_str("hand"),
            Self::Rig => f.write_str("rig"),
            Self::Sense(finger) => write!(f, "sense-{finger}"),
            Self::Order => f.write_str("order"),
            Self::Stop => f.write_str("stop"),
            Self::Watch => f.write_str("watch"),
        }
    }
}

impl FromStr for Right {
    type Err = RightError;

    fn from_str(text: &str) -> Result<Self, RightError> {
        let found = Self::all().into_iter().find(|r| r.to_string() == text);
        found.ok_or_else(|| RightError::Unknown { given: text.into() })
    }
}

/// Common name of a certificate: right and serial number, e.g. `sense-0.17`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct CertificateName {
    /// Right of the holder.
    pub right: Right,
    /// Serial number among the lab's certificates for this right, from 1 to `MAX_SERIAL`. Never reused.
    pub serial: u32,
}

impl fmt::Display for CertificateName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}", self.right, self.serial)
    }
}

impl FromStr for CertificateName {
    type Err = RightError;

    fn from_str(text: &str) -> Result<Self, RightError> {
        let read = || {
            let (right, serial) = text.split_once('.')?;
            let (right, serial) = (right.parse().ok()?, serial.parse().ok()?);
            let name = Self { right, serial };
            // Only the canonical spelling is accepted: sense-0.07 is not sense-0.7.
            let sound = (1..=MAX_SERIAL).contains(&serial) && name.to_string() == text;
            sound.then_some(name)
        };
        read().ok_or_else(|| RightError::Name { given: text.into() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_canonical_names_are_parsed() {
        for right in Right::all() {
            assert_eq!(right.to_string().parse(), Ok(right));
            let name = CertificateName { right, serial: 17 };
            assert_eq!(name.to_string().parse(), Ok(name));
        }
        for wrong in [
            "",
            "hand",
            "hand.",
            "hand.0",
            "hand.01",
            "hand.+1",
            "hand.1000",
            "hand.1.1",
            "sense-5.1",
            "sense-00.1",
            "Hand.1",
            " hand.1",
            "feeler lab",
        ] {
            assert!(wrong.parse::<CertificateName>().is_err(), "{wrong}");
        }
        assert!("sense".parse::<Right>().is_err());
    }

    #[test]
    fn folder_of_a_right_is_preferred() {
        let folder = std::env::temp_dir().join(format!("feeler-right-{}", std::process::id()));
        std::fs::create_dir_all(folder.join("stop")).unwrap();
        let found = Right::folder_in(&folder, &[Right::Order, Right::Stop]);
        assert_eq!(found, folder.join("stop"));
        assert_eq!(Right::folder_in(&folder, &[Right::Hand]), folder);
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
