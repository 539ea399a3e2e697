//! Tactile sensing: from an image of the dome's inside to tri-axial forces on its elements.
//!
//! The stages are: image ([`Camera`](image::Camera), [`Frame`](image::Frame)) → integrated gray value and centroid per element ([`moments`], with
//! the dewarping of [`fingertip`]) → forces ([`calibration`]) → [`TactileFrame`](forces::TactileFrame). [`SensingChain`](forces::SensingChain) is the complete chain, which also
//! works without a calibration; [`OpticalSensor`](forces::OpticalSensor) connects it to a camera.
//!
//! [`contact`] estimates the position, size and force of a contact.
//!
//! Three-axis taxel arrays have no images: [`taxel`] reads their tables, and [`skin`] decodes their serial protocols. [`table`] reads tables of all kinds.

pub mod calibration;
pub mod contact;
pub mod fingertip;
pub mod forces;
pub mod image;
pub mod locate;
pub mod moments;
pub mod skin;
pub mod table;
pub mod taxel;
pub mod track;
pub mod wrench;
