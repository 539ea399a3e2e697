//! Natural order of file names: `frame9` before `frame10`.

use std::cmp::Ordering;
use std::iter::Peekable;
use std::str::Chars;

/// Compares two names; runs of digits compare as numbers. Names that differ only in leading zeros compare by their
/// characters.
pub fn compare(a: &str, b: &str) -> Ordering {
    let (mut left, mut right) = (a.chars().peekable(), b.chars().peekable());
    loop {
        let order = match (left.peek().copied(), right.peek().copied()) {
            (None, None) => return a.cmp(b),
            (Some(l), Some(r)) if l.is_ascii_digit() && r.is_ascii_digit() => {
                let (l, r) = (number(&mut left), number(&mut right));
                l.len().cmp(&r.len()).then_with(|| l.cmp(&r))
            }
            _ => left.next().cmp(&right.next()),
        };
        if order != Ordering::Equal {
            return order;
        }
    }
}

/// Reads a run of digits of any length and returns it without leading zeros.
fn number(characters: &mut Peekable<Chars>) -> String {
    let mut digits = String::new();
    while let Some(digit) = characters.next_if(char::is_ascii_digit) {
        if !(digits.is_empty() && digit == '0') {
            digits.push(digit);
        }
    }
    digits
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digit_runs_compare_as_numbers() {
        let mut names = [
            "b", "f10.png", "f9.png", "f010.png", "f9b", "a-2-10", "a-2-9", "f", "F10",
        ];
        names.sort_by(|a, b| compare(a, b));
        let sorted = [
            "F10", "a-2-9", "a-2-10", "b", "f", "f9.png", "f9b", "f010.png", "f10.png",
        ];
        assert_eq!(names, sorted);
        let long = "9".repeat(400);
        assert_eq!(
            compare(&format!("{long}1"), &format!("{long}2")),
            Ordering::Less
        );
    }
}
