//! Errors of skins.

use feeler::sensor::taxel::TaxelError;
use std::io;
use std::path::{Path, PathBuf};

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
        /// Error of the operating system.
        source: io::Error,
    },
    /// A skin cannot be emulated.
    #[error("failed to emulate a skin{}: {source}", shown(link))]
    Emulator {
        /// Requested symbolic link to the port; empty if none was requested.
        link: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
}

fn shown(link: &Path) -> String {
    match link.as_os_str().is_empty() {
        true => String::new(),
        false => format!(" with the link {}", link.display()),
    }
}
