//! The built-in experiments and control laws that a page can offer.

use crate::js;
use feeler::control::law::LawConfig;
use feeler_lab::config::{BUILT_IN, Experiment, ExperimentConfig, Sensing};
use serde::Serialize;
use wasm_bindgen::prelude::*;

/// Experiments and laws that a page can run.
#[derive(Serialize)]
struct Catalogue {
    version: &'static str,
    experiments: Vec<Entry>,
    laws: &'static [&'static str],
}

/// A built-in experiment.
#[derive(Serialize)]
struct Entry {
    name: &'static str,
    description: String,
    seed: u64,
    sensing: Sensing,
    law: &'static str,
    /// Values of the experiment, with defaults.
    config: ExperimentConfig,
}

/// Returns the built-in experiments that contain a simulated world, and the control laws, as JSON:
/// `{version, experiments: [{name, description, seed, sensing, law, config}], laws}`.
///
/// # Errors
/// Never for valid built-in experiments.
#[wasm_bindgen]
pub fn catalogue() -> Result<String, JsError> {
    let mut experiments = Vec::new();
    for built_in in BUILT_IN {
        let config = Experiment::load(built_in.name, &[]).map_err(js)?.config;
        experiments.push(Entry {
            name: built_in.name,
            description: config.description.clone(),
            seed: config.seed,
            sensing: config.sensing,
            law: config.control.law.name(),
            config,
        });
    }
    let catalogue = Catalogue {
        version: env!("CARGO_PKG_VERSION"),
        experiments,
        laws: &LawConfig::NAMES,
    };
    serde_json::to_string(&catalogue).map_err(js)
}
