//! Values of experiment files, without feeler-lab, which loads whole experiments.

use serde::de::DeserializeOwned;
use std::path::Path;

/// Text of a file in `crates/feeler-lab`.
pub fn text(file: &str) -> String {
    let lab = Path::new(env!("CARGO_MANIFEST_DIR")).join("../feeler-lab");
    std::fs::read_to_string(lab.join(file)).expect("a file")
}

/// Value of `key`, such as `sim` or `sensor.fingertip`, in an experiment file in `crates/feeler-lab`.
pub fn read<T: DeserializeOwned>(file: &str, key: &str) -> T {
    let table = toml::Value::Table(text(file).parse().expect("TOML"));
    let value = key.split('.').fold(&table, |table, key| &table[key]);
    value.clone().try_into().expect("a value of this type")
}
