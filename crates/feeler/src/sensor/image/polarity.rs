//! Polarity of elements: bright on dark or dark on bright.

use serde::{Deserialize, Serialize};

/// Brightness of the elements relative to their background.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Polarity {
    /// Bright on dark: white pins, fibre ends, or contacts from which light emerges.
    #[default]
    Bright,
    /// Dark on bright: markers printed on a gel.
    Dark,
}

impl Polarity {
    /// Returns `true` if the polarity is [`Polarity::Bright`].
    pub fn is_bright(&self) -> bool {
        *self == Self::Bright
    }
}

/// Error of parsing a [`Polarity`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("expected bright or dark, got {0:?}")]
pub struct ParsePolarityError(String);

impl std::str::FromStr for Polarity {
    type Err = ParsePolarityError;

    fn from_str(text: &str) -> Result<Self, ParsePolarityError> {
        let all = [Self::Bright, Self::Dark].into_iter();
        let mut named = all.filter(|polarity| polarity.to_string() == text);
        named.next().ok_or_else(|| ParsePolarityError(text.into()))
    }
}

impl std::fmt::Display for Polarity {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Bright => "bright",
            Self::Dark => "dark",
        })
    }
}
