//! Reports of recordings selected by the user.

use crate::js;
use crate::js_file::JsFile;
use feeler_report::run::page_from;
use js_sys::Function;
use std::io::BufReader;
use std::path::Path;
use wasm_bindgen::prelude::*;
use web_sys::File;

/// Number of bytes that are read from a file at once.
const BLOCK: usize = 1 << 20;

/// Returns the report page (HTML) of a recording. Calls `progress` with the fraction that has been read, 0 to 1. The
/// file is read in blocks, so it may be larger than the memory; only the report must fit.
///
/// # Errors
/// If the file is not a recording, not even the run's facts are readable, or this is not called in a worker.
#[wasm_bindgen]
pub fn report(file: &File, progress: &Function) -> Result<String, JsValue> {
    let name = file.name();
    let file = JsFile::new(file.clone().into())?;
    let length = file.len();
    let mut reader = BufReader::with_capacity(BLOCK, file);
    let mut told = |share: f64| {
        // A page that cannot show the progress still gets its report.
        let _ = progress.call1(&JsValue::NULL, &share.into());
    };
    Ok(page_from(&mut reader, length, Path::new(&name), &mut told).map_err(js)?)
}
