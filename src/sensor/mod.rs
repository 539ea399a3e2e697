//! The sensor program: from a picture of the dome's inside to tri-axial forces on its elements.

pub mod camera;
pub mod frame;
pub mod layout;
pub mod reading;
