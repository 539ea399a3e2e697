//! Tactile sensing: from an image of the dome's inside to tri-axial forces on its elements.
//!
//! The stages are: image ([`camera`], [`frame`]) → integrated gray value and centroid per element ([`moments`], with
//! the dewarping of [`dome`]) → forces ([`calibration`]) → [`reading`]. [`sensing`] is the complete chain, which also
//! works without a calibration; [`optical`] connects it to a camera.
//!
//! Three-axis taxel arrays have no images: [`taxel`] reads their tables. [`table`] reads tables of all kinds.

pub mod calibration;
pub mod fingertip;
pub mod forces;
pub mod image;
pub mod locate;
pub mod moments;
pub mod table;
pub mod taxel;
pub mod track;
pub mod wrench;
