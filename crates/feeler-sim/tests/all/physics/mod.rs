//! Feelers, caps, holders and instruments, compared with physics derived by hand. Each tolerance is explained where it is
//! used.

mod cap;
mod columnar_feeler;
mod holder;
mod instruments;
mod one_element;
mod one_feeler;
mod relaxation;
mod rim;
