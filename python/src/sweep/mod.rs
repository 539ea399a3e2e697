//! Sweeps: the trials of a plan, the folder that they are kept in, and its table as columns.

mod columns;
mod store;
mod trials;

pub use columns::read_table;
pub use store::Store;
pub use trials::Trials;
