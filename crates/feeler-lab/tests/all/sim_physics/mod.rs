//! The simulated rig, compared with physics derived by hand. Each tolerance is explained where it is used.

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
