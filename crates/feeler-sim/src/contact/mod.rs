//! Contact of columnar feelers with objects: detection, stick and slip, grip, balance of forces.

pub(crate) mod balance;
pub(crate) mod columnar_feeler;
pub(crate) mod contacts;
pub(crate) mod detection;
pub(crate) mod feeler_config;
pub(crate) mod grip;
pub(crate) mod relaxation;
pub(crate) mod settle;
pub(crate) mod slip;
pub(crate) mod slips;

pub use columnar_feeler::{Anchor, Overload, Tip};
pub use feeler_config::{FeelerConfig, Friction};
pub use relaxation::RelaxationConfig;
