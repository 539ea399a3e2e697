//! The simulated world: fixed model, state, and one time step.

pub(crate) mod config;
pub(crate) mod model;
pub(crate) mod simulation;
pub(crate) mod start;
pub(crate) mod state;
pub(crate) mod step;

pub use crate::contact::contacts::Contact;
pub use config::{DirectSensingConfig, SimConfig, VariationConfig};
pub use model::WorldModel;
pub use simulation::World;
pub use state::{FingerState, State};
