//! `feeler certificates`: a lab's own certificate authority, and a certificate for each computer.

use crate::{CommandError, Outcome};
use std::io::Write;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Folder of the lab's authority: made when there is none. Keep it where nobody else reads it.
    lab: PathBuf,
    /// Name or address of a computer (10.0.0.5, sensors.lab) to make certificates for, in the folder of that
    /// name beside the authority: copy it there, and name it with --certificates.
    #[arg(required = true)]
    computers: Vec<String>,
}

/// Makes certificates.
#[cfg(feature = "link")]
pub fn certificates(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    use feeler_link::certificates::Authority;
    let authority = Authority::open_or_make(&arguments.lab)?;
    for computer in &arguments.computers {
        let folder = authority.certify(computer)?;
        writeln!(out, "{}", folder.display())?;
    }
    Ok(Outcome::Done)
}

/// Says that there is no link.
#[cfg(not(feature = "link"))]
pub fn certificates(arguments: &Arguments, _: &mut dyn Write) -> Result<Outcome, CommandError> {
    let lab = arguments.lab.display();
    let computers = arguments.computers.join(", ");
    Err(format!("{lab}: no certificates for {computers}: this program was built without the link; build it with --features link").into())
}
