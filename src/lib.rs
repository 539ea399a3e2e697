//! Feeler turns what a soft robotic fingertip feels into how the finger moves.

pub mod hand;
pub mod sensor;
pub mod sim;
