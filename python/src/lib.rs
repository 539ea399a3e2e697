//! Native module of the Python package `feeler`: operates on arrays with the interpreter released.
//!
//! Names, defaults and argument checks are in Python; see `python/feeler`.

mod calibration;
mod contacts;
mod control;
mod environment;
mod errors;
mod flags;
mod interrupt;
mod layout;
mod places;
mod recording;
mod run;
mod sensing;
mod sweep;
mod wrenches;

use pyo3::prelude::*;

/// Native module of the package `feeler`.
#[pymodule(gil_used = false)]
mod _core {
    #[pymodule_export]
    #[allow(non_upper_case_globals, reason = "Python's name")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
    #[pymodule_export]
    use super::calibration::{Calibration, calibrate_file, calibrate_frames, simulate_loads};
    #[pymodule_export]
    use super::contacts::estimate_contacts;
    #[pymodule_export]
    use super::control::{FingerSense, HandSense, Plan, Session};
    #[pymodule_export]
    use super::environment::{EnvironmentSpec, ManyEnvironments, SingleEnvironment};
    #[pymodule_export]
    use super::flags::raise_flags;
    #[pymodule_export]
    use super::layout::{Layout, locate_elements};
    #[pymodule_export]
    use super::recording::Recording;
    #[pymodule_export]
    use super::run::{RunOutcome, report, run};
    #[pymodule_export]
    use super::sensing::Sensor;
    #[pymodule_export]
    use super::sweep::{Store, Trials, read_table};
    #[pymodule_export]
    use super::wrenches::WrenchEstimator;
}
