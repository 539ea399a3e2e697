//! The simulated rig against physics derived by hand. Every tolerance has its reason beside it.

mod cap;
mod columnar_feeler;
mod convergence;
mod every_step;
mod holder;
mod instruments;
mod one_element;
mod one_feeler;
mod reference;
mod relaxation;
mod rim;
mod side_by_side;
