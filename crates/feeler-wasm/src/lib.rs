#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

mod catalogue;
mod fingertip;
mod forces;
mod js_file;
mod report;
mod run;

pub use catalogue::{catalogue, experiment};
pub use fingertip::Fingertip;
pub use report::report;
pub use run::{FinishedRun, Run};

use wasm_bindgen::JsError;

/// Converts an error to a JavaScript error with the same message.
fn js(error: impl std::fmt::Display) -> JsError {
    JsError::new(&error.to_string())
}
