//! `feeler list`

use super::{CommandError, Outcome};
use crate::config::{BUILT_IN, Experiment};

pub fn list() -> Result<Outcome, CommandError> {
    for built_in in BUILT_IN {
        let experiment = Experiment::load(built_in.name, &[])?;
        println!("{:16} {}", built_in.name, experiment.config.description);
    }
    Ok(Outcome::Done)
}
