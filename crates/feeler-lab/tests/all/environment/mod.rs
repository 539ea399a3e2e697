//! Learning environments: equivalence with `feeler run`, rewards and errors.

mod episodes;
mod picture;
mod rewards;
mod same_run;
mod support;
mod vector;
