//! Sweeps: the trials of a plan, their folder, and the table as columns.

mod columns;
mod store;
mod trials;

pub use columns::read_table;
pub use store::Store;
pub use trials::Trials;
