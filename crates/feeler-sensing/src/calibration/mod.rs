//! Calibration of a fingertip: guided loading, checks of loads, pages.

pub mod checks;
mod guided;
mod page;
mod passport;
mod simulated_loads;
mod taxel_series;
mod verify;
mod wrench_page;
mod wrench_table;

pub use guided::{FORCES, ForceAddress, GuideOptions, LOADS, Procedure, guide};
pub use page::page;
pub use passport::{require_verified, today};
pub use simulated_loads::write_simulated_loads;
pub use taxel_series::{TaxelRecordings, read_taxel_recordings};
pub use verify::{VerifyOptions, verify};
pub use wrench_page::wrench_page;
pub use wrench_table::wrench_table;
