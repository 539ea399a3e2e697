//! Stub for builds without GenICam cameras.

use super::Kind;
use feeler_sensing::NO_GENICAM;

pub fn list(_: bool) -> Kind {
    Kind {
        name: "GenICam",
        cameras: Vec::new(),
        missing: vec![NO_GENICAM.into()],
    }
}
