//! Generates JavaScript functions for a WebAssembly module, as the program `wasm-bindgen` does. Part of the workspace, so
//! that its version matches the `wasm-bindgen` with which the module is compiled.
//! Usage: `feeler-bindgen MODULE.wasm FOLDER`

use anyhow::{Result, bail};
use wasm_bindgen_cli_support::Bindgen;

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [module, folder] = &arguments[..] else {
        bail!("expected two arguments: MODULE.wasm FOLDER");
    };
    Bindgen::new()
        .input_path(module)
        .web(true)?
        .typescript(false)
        .generate(folder)
}
