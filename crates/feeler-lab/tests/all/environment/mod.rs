//! Learning environments: that they are the runs that `feeler run` makes, what they reward, and what they refuse.

mod episodes;
mod picture;
mod rewards;
mod same_run;
mod support;
mod vector;
