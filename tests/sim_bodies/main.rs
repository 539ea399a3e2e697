//! Free bodies: on a table, on an incline, and pushed by feelers.

mod pushed;
mod scene;
mod table;
