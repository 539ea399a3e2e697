//! Built-in taxel layouts.

use super::{TaxelError, TaxelLayout};

/// A built-in layout.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BuiltInTaxels {
    /// Name of the layout.
    pub name: &'static str,
    /// Text of its file.
    pub text: &'static str,
}

/// All built-in layouts.
pub const BUILT_IN_TAXELS: [BuiltInTaxels; 7] = [
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
        name: "reskin",
        text: include_str!("../../../taxels/reskin.toml"),
    },
    BuiltInTaxels {
        name: "flexitac",
        text: include_str!("../../../taxels/flexitac.toml"),
    },
    BuiltInTaxels {
        name: "paxini-s1813e",
        text: include_str!("../../../taxels/paxini-s1813e.toml"),
    },
    BuiltInTaxels {
        name: "papillarray",
        text: include_str!("../../../taxels/papillarray.toml"),
    },
];

impl BuiltInTaxels {
    /// Returns the layout called `name`, or `None` if missing.
    pub fn named(name: &str) -> Option<Self> {
        BUILT_IN_TAXELS.into_iter().find(|b| b.name == name)
    }

    /// Parses the layout.
    ///
    /// # Errors
    /// Never in practice: tests parse all built-in layouts.
    pub fn layout(&self) -> Result<TaxelLayout, TaxelError> {
        TaxelLayout::from_toml(self.text)
    }
}
