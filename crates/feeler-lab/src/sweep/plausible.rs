//! Plausible hands: rubber, bottle, drives and instruments drawn from the ranges that come with the program.

use super::SweepError;
use super::parameter::{Parameter, settings};
use super::ranges;
use super::trial::generator;
use crate::config::Experiment;
use std::path::Path;

/// The experiment whose ranges are drawn from, and the group of them that is decided before anybody tunes anything.
const RANGES: (&str, &str) = ("cap-closing", "apparatus");

/// The settings, as `KEY=VALUE`, that give `experiment` the plausible hand number `hand`.
///
/// Each value is drawn independently of the others, from a random stream of its own.
///
/// # Errors
/// If the experiment lacks a key that is drawn.
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
