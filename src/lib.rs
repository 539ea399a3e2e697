//! Feeler turns what a soft robotic fingertip feels into how the finger moves.

pub mod cli;
pub mod config;
pub mod control;
pub mod experiment;
pub mod hand;
pub mod record;
pub mod report;
pub mod sensor;
pub mod sim;
