//! Statements of docs/real-data.md, checked on public recordings of real sensors if they are available (`FEELER_DATA`).
//! Counts and names are taken from the recordings, so that similar recordings can be used as well.

mod blobs;
mod eflesh_force;
mod faulty_pictures;
mod fibres;
mod fit;
mod gelsight;
mod kinds_of_load;
mod sheared;
mod slip;
mod video;
