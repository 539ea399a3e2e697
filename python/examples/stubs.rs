//! Prints the type stubs of a built `feeler._core`: `stubs target/debug/lib_core.so`.

use std::error::Error;
use std::path::PathBuf;

use pyo3_introspection::{introspect_cdylib, module_stub_files};

fn main() -> Result<(), Box<dyn Error>> {
    let library = std::env::args_os()
        .nth(1)
        .ok_or("expected the path of the built module")?;
    let stubs = module_stub_files(&introspect_cdylib(library, "_core")?);
    // The module has no submodules.
    let root = stubs
        .get(&PathBuf::from("__init__.pyi"))
        .ok_or("the module contains no type information; build it with the feature `stubs`")?;
    print!("{root}");
    Ok(())
}
