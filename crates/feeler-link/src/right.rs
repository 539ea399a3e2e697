//! What the holder of a certificate may do, and the name by which a certificate says so.

use feeler::hand::MAX_FINGERS;
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Largest serial number of a certificate: a program names all certificates whose messages it takes, by right and
/// number.
pub const MOST_SERIAL: u32 = 999;

/// What a program may do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Right {
    /// To be the hand.
    Hand,
    /// To be the rig: encoders, drives, simulated cameras.
    Rig,
    /// To sense for the finger of this number.
    Sense(usize),
    /// To stop the hand and let it go on, and to watch.
    Order,
    /// To stop the hand.
    Stop,
    /// To watch.
    Watch,
}

/// Why a word is no right, or a name is no certificate's.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RightError {
    /// No such right.
    #[error(
        "{given:?} is no right: expected hand, rig, sense-0 to sense-{}, order, stop or watch",
        MAX_FINGERS - 1
    )]
    Unknown {
        /// What was given.
        given: String,
    },
    /// No such name.
    #[error(
        "{given:?} is no certificate's name: expected a right and a number from 1 to {MOST_SERIAL}, as in sense-0.17"
    )]
    Name {
        /// What was given.
        given: String,
    },
}

impl Right {
    /// All rights.
    pub fn all() -> Vec<Self> {
        let mut rights = vec![Self::Hand, Self::Rig];
        rights.extend((0..MAX_FINGERS).map(Self::Sense));
        rights.extend([Self::Order, Self::Stop, Self::Watch]);
        rights
    }

    /// Where the certificate of a program is that may act by any of `rights`, the first one first: in the folder of
    /// that name in `folder`, or in `folder` itself.
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

/// The common name of a certificate: its right, and its number among the lab's certificates of that right.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct CertificateName {
    /// What its holder may do.
    pub right: Right,
    /// From 1 to [`MOST_SERIAL`]; never given twice.
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
            // One name for one certificate: sense-0.7 is not sense-0.07.
            let sound = (1..=MOST_SERIAL).contains(&serial) && name.to_string() == text;
            sound.then_some(name)
        };
        read().ok_or_else(|| RightError::Name { given: text.into() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_read_as_it_is_written_and_no_other_is() {
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
    fn a_program_finds_the_folder_of_its_right_or_takes_the_whole() {
        let folder = std::env::temp_dir().join(format!("feeler-right-{}", std::process::id()));
        std::fs::create_dir_all(folder.join("stop")).unwrap();
        let found = Right::folder_in(&folder, &[Right::Order, Right::Stop]);
        assert_eq!(found, folder.join("stop"));
        assert_eq!(Right::folder_in(&folder, &[Right::Hand]), folder);
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
