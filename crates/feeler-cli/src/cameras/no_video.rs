//! Stub for builds without Video4Linux cameras.

use super::Kind;
use feeler_sensing::NO_VIDEO;

pub fn list() -> Kind {
    Kind {
        name: "Video4Linux",
        cameras: Vec::new(),
        missing: vec![NO_VIDEO.into()],
    }
}
