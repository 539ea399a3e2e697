//! The built-in experiments and control laws that a page can offer.

use crate::js;
use feeler::control::law::LawConfig;
use feeler_lab::config::{BUILT_IN, BuiltIn, Experiment, ExperimentConfig, Sensing};
use serde::Serialize;
use wasm_bindgen::prelude::*;

/// Names of the experiments and laws that a page can run.
#[derive(Serialize)]
struct Catalogue {
    version: &'static str,
    experiments: [&'static str; BUILT_IN.len()],
    laws: &'static [&'static str],
}

/// A built-in experiment.
#[derive(Serialize)]
struct Entry {
    name: String,
    description: String,
    seed: u64,
    sensing: Sensing,
    law: &'static str,
    /// Values of the experiment, including defaults.
    config: ExperimentConfig,
}

/// Returns the names of the built-in experiments and control laws as JSON: `{version, experiments: [name], laws: [name]}`.
///
/// # Errors
/// Never; required by serde's signature.
#[wasm_bindgen]
pub fn catalogue() -> Result<String, JsError> {
    let catalogue = Catalogue {
        version: env!("CARGO_PKG_VERSION"),
        experiments: BUILT_IN.map(|BuiltIn { name, .. }| name),
        laws: &LawConfig::NAMES,
    };
    serde_json::to_string(&catalogue).map_err(js)
}

/// Returns the built-in experiment `name` as JSON: `{name, description, seed, sensing, law, config}`.
///
/// # Errors
/// If there is no such experiment.
#[wasm_bindgen]
pub fn experiment(name: &str) -> Result<String, JsError> {
    let config = Experiment::load(name, &[]).map_err(js)?.config;
    let entry = Entry {
        name: name.into(),
        description: config.description.clone(),
        seed: config.seed,
        sensing: config.sensing,
        law: config.control.law.name(),
        config,
    };
    serde_json::to_string(&entry).map_err(js)
}
