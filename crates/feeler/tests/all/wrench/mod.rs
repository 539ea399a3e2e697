//! Wrenches on a whole fingertip: learning from images, rejected data, and control of a hand.

mod control;
mod copies;
mod file;
mod learning;
mod modes;
mod taxels;
mod world;
