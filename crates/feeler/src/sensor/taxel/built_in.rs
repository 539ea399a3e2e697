//! The layouts that come with feeler.

use super::{TaxelError, TaxelLayout};

/// A layout that comes with feeler.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BuiltInTaxels {
    /// What it is called.
    pub name: &'static str,
    /// Its file.
    pub text: &'static str,
}

/// The layouts that come with feeler.
pub const BUILT_IN_TAXELS: [BuiltInTaxels; 4] = [
    BuiltInTaxels {
        name: "uskin-4x4",
        text: include_str!("../../../taxels/uskin-4x4.toml"),
    },
    BuiltInTaxels {
        name: "eflesh",
        text: include_str!("../../../taxels/eflesh.toml"),
    },
    BuiltInTaxels {
        name: "anyskin",
        text: include_str!("../../../taxels/anyskin.toml"),
    },
    BuiltInTaxels {
        name: "papillarray",
        text: include_str!("../../../taxels/papillarray.toml"),
    },
];

impl BuiltInTaxels {
    /// The one of this name.
    pub fn named(name: &str) -> Option<Self> {
        BUILT_IN_TAXELS.into_iter().find(|b| b.name == name)
    }

    /// Its layout.
    ///
    /// # Errors
    /// None that a test would not have found.
    pub fn layout(&self) -> Result<TaxelLayout, TaxelError> {
        TaxelLayout::from_toml(self.text)
    }
}
