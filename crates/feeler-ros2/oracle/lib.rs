//! Empty crate; its tests are in `tests`.
