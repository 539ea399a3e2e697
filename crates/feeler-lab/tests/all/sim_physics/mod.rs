//! The simulated rig in whole runs: invariants of every step, and independence of the step's length and of vectorization.

mod convergence;
mod every_step;
mod other_bottles;
mod reference;
mod side_by_side;
