//! Values that are typed while the program runs.

use std::fmt::Display;
use std::io::{BufRead, Write, stderr, stdin};
use std::str::FromStr;
use std::sync::mpsc::{Receiver, channel};

/// Value of an option that enables values from standard input.
#[cfg(target_os = "linux")]
const TYPED: &str = "-";

/// Parses the values of the option `--KIND`, and returns them with those typed on standard input if one is `-`.
///
/// # Errors
/// If a value is invalid.
#[cfg(target_os = "linux")]
pub fn given_and_typed<T>(
    kind: &'static str,
    given: &[String],
) -> Result<(Vec<T>, Option<Receiver<T>>), String>
where
    T: FromStr<Err: Display> + Send + 'static,
{
    let values = given.iter().filter(|value| *value != TYPED);
    let values = values.map(|value| value.parse().map_err(|error| format!("--{kind} {error}")));
    let values = values.collect::<Result<_, _>>()?;
    let typed = given.iter().any(|value| value == TYPED);
    Ok((values, typed.then(|| typed_lines(kind))))
}

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
