//! Real-time schedules of control steps, and statistics of their punctuality.
//!
//! The control loop itself never reads a clock. A program that runs it on a real hand waits between its steps:
//!
//! ```no_run
//! use feeler::pace::{FixedRate, Punctuality};
//! # use std::sync::atomic::AtomicBool;
//! # fn main() -> Result<(), feeler::pace::PaceError> {
//! # let interrupted = AtomicBool::new(false);
//! # let step = |_| ();
//! let mut punctuality = Punctuality::new()?;
//! let mut pace = FixedRate::new(0.01)?;
//! while let Some(tick) = pace.wait_interruptible(&interrupted) {
//!     punctuality.record(&tick);
//!     step(tick.missed);
//! }
//! println!("{}", punctuality.summary());
//! # Ok(())
//! # }
//! ```

pub(crate) mod clock;
pub(crate) mod error;
pub(crate) mod following;
pub(crate) mod punctuality;
pub mod real_time;
pub(crate) mod schedule;
pub(crate) mod timer;

pub use clock::{Clock, Monotonic};
pub use error::PaceError;
pub use following::{DataDriven, StepTrigger};
pub use punctuality::{Punctuality, PunctualitySummary};
pub use schedule::{FreeRunning, Schedule};
pub use timer::{FixedRate, Tick};
