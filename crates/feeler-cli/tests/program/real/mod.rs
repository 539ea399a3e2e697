//! What docs/real-data.md says of recordings of real sensors that others made, where they are at hand (`FEELER_DATA`). Counts and names
//! are taken from the recordings, so that others of the same kind serve as well.

mod blobs;
mod fibres;
mod fit;
mod gelsight;
mod kinds_of_load;
mod slip;
mod video;
