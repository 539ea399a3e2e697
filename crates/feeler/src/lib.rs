//! Feeler turns what a soft robotic fingertip feels into how the finger moves.
//!
//! ```text
//! camera frame -> element moments -> tri-axial forces -> flags -> fingertip velocity -> joint velocity
//! [ sensor: one per fingertip                       ]    [ control, hand                              ]
//! ```
//!
//! It implements the system of Ohka, Morisawa and Yussof, *Trajectory Generation of Robotic Fingers
//! Based on Tri-axial Tactile Data for Cap Screwing Task* (2009), called "the paper" throughout, and
//! simulates the rig that it runs on.
//!
//! # Conventions
//!
//! SI units everywhere, angles in radians; a suffix (`_px`, `_deg`) where another unit enters. Frames:
//! world `W` (z up, origin on the bottle's axis), finger base `B`, fingertip `T` (origin at the dome's
//! centre, x along the dome's axis, outward), element `E_i` (z along the element's outward normal).
//! An element's force is `F_x, F_y`, the tangential force on the feeler by the object, and `F_z`, its
//! compression, positive when pressed.
//!
//! # Where to start
//!
//! [`sensor::optical::OpticalSensor`] turns pictures
//! into forces, [`sensor::sensing::Sensing`] into all that they say;
//! [`control::control_loop::ControlLoop`] closes the loop over any
//! [`TactileSensor`](sensor::reading::TactileSensor) and [`Hand`](hand::hand::Hand).

#![warn(missing_docs)]

pub mod control;
pub mod hand;
pub mod pace;
pub mod sensor;
