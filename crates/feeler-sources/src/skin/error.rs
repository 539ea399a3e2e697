//! Errors of skins.

use feeler::sensor::taxel::TaxelError;
use std::io;

/// Error of opening a skin.
#[derive(Debug, thiserror::Error)]
pub enum SkinError {
    /// The layout does not describe a protocol.
    #[error(
        "the layout {layout:?} has no table [serial]; expected the protocol of the skin, as in serial = {{ protocol = \"magnetometers\", baud_rate = 115200 }}"
    )]
    NoProtocol {
        /// Name of the layout.
        layout: String,
    },
    /// The layout is invalid.
    #[error(transparent)]
    Layout(#[from] TaxelError),
    /// The port cannot be opened.
    #[error("serial:{path}: {source}; list the ports with `feeler skins`")]
    Port {
        /// Path of the port.
        path: String,
        /// Error of the system.
        source: io::Error,
    },
}
