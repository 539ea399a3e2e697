//! Free bodies: on a table, on an incline, and pushed by feelers.

mod energy;
mod pushed;
mod scene;
mod table;
