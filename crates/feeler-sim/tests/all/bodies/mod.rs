//! Free bodies: on a table, on an incline, and pushed by feelers.

mod carried;
mod energy;
mod pushed;
pub mod scene;
mod table;
