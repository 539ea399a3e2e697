#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

mod interrupt;
mod outcome;
mod output;
mod part_file;
mod progress;
mod table_file;
mod warnings;

pub use interrupt::{exit_on_interrupt, is_raised, watch_for_interrupt};
pub use outcome::{CommandError, Outcome};
pub use output::{Output, print_json};
pub use part_file::{OutputError, Outputs, PartFile, cut_torn_line};
pub use progress::{Bar, Reading, Search, Steps, Working};
pub use table_file::open_table;
pub use warnings::{Warnings, warn};
