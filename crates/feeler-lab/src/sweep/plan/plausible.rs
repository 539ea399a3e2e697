//! Plausible hands: rubber, bottle, drives and instruments drawn from built-in ranges.

use super::parameter::{Parameter, settings};
use super::ranges;
use crate::config::Experiment;
use crate::sweep::SweepError;
use crate::sweep::trial::generator;
use std::path::Path;

/// Built-in ranges to draw from, and the group of parameters that is fixed before any tuning.
const RANGES: (&str, &str) = ("cap-closing", "apparatus");

/// Returns the settings (`KEY=VALUE`) that turn `experiment` into the plausible hand with number `hand`.
///
/// The values are drawn independently, each from a separate random stream.
///
/// # Errors
/// If the experiment lacks a drawn key.
pub fn plausible_hand(experiment: &Experiment, hand: u64) -> Result<Vec<String>, SweepError> {
    let files: [&Path; 0] = [];
    let entries = ranges::load(&files, RANGES.0)?.parameter;
    let drawn = entries.iter().filter(|entry| entry.group == RANGES.1);
    let drawn = drawn.map(|entry| {
        let parameter = Parameter::of_entry(entry, experiment)?;
        let mut stream = generator(hand, 0, &entry.name);
        let value = parameter.distribution.draw(&mut stream, parameter.whole);
        Ok((parameter, value))
    });
    let drawn = drawn.collect::<Result<Vec<_>, SweepError>>()?;
    settings(drawn.iter().map(|(parameter, value)| (parameter, value)))
}
