//! Values that are typed while the program runs.

use std::fmt::Display;
use std::io::{BufRead, Write, stderr, stdin};
use std::str::FromStr;
use std::sync::mpsc::{Receiver, channel};

/// Reads values of this `kind` from standard input on a background thread, one per line; reports invalid lines on standard
/// error.
pub fn typed_lines<T>(kind: &'static str) -> Receiver<T>
where
    T: FromStr<Err: Display> + Send + 'static,
{
    let (sender, values) = channel();
    std::thread::spawn(move || {
        for line in stdin().lock().lines().map_while(Result::ok) {
            match line.trim().parse() {
                Ok(value) => {
                    if sender.send(value).is_err() {
                        return;
                    }
                }
                // If standard error is closed, the invalid line is ignored silently.
                Err(error) => {
                    let _ = writeln!(stderr(), "invalid {kind}: {error}");
                }
            }
        }
    });
    values
}
