//! Built-in taxel layouts.

use super::{TaxelError, TaxelLayout};

/// Layout of a taxel array that is part of this crate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BuiltInTaxels {
    /// Name of the layout.
    pub name: &'static str,
    /// Text of the layout file.
    pub text: &'static str,
}

/// Creates the array of built-in layouts from the files with the given names.
macro_rules! built_in {
    ($($name:literal),* $(,)?) => {
        [$(BuiltInTaxels {
            name: $name,
            text: include_str!(concat!("../../../taxels/", $name, ".toml")),
        }),*]
    };
}

/// All built-in layouts.
pub const BUILT_IN_TAXELS: [BuiltInTaxels; 7] = built_in![
    "uskin-4x4",
    "eflesh",
    "anyskin",
    "reskin",
    "flexitac",
    "paxini-s1813e",
    "papillarray",
];

impl BuiltInTaxels {
    /// Returns the built-in layout called `name`, or `None` if it does not exist.
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
