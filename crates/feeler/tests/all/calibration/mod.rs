//! Calibrations of elements whose forces are known functions of their moments.

mod coupled;
mod element;
mod errors;
mod file;
mod quality;
mod separable;
