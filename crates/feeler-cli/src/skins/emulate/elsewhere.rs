//! `feeler skins emulate` on Windows and macOS: not supported.

use super::EmulateArguments;
use crate::{CommandError, Outcome};
use std::io::Write;

pub fn emulate(_: &EmulateArguments, _: &mut dyn Write) -> Result<Outcome, CommandError> {
    Err("emulated skins require Linux; run this command on Linux".into())
}
