//! A wrench on a whole fingertip: what is learned of it from pictures, what is refused, and a hand that is controlled by it.

mod control;
mod file;
mod learning;
mod world;
