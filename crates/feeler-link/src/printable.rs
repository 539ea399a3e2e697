//! Words from elsewhere, made fit for a screen and a record.

/// Bytes that are kept of a text from another program.
pub const MOST_BYTES: usize = 256;

/// `text`, at most [`MOST_BYTES`] of it, on one line: what a terminal would obey (control characters, escape
/// sequences, changes of the direction of writing) is shown as `\n` or `\u{1b}`.
pub fn printable(text: &str) -> String {
    let mut shown = String::with_capacity(text.len().min(MOST_BYTES));
    for character in text.chars() {
        let length = shown.len();
        match character {
            // Of no harm; and a text that went through here stays the same.
            '"' | '\'' | '\\' => shown.push(character),
            other => shown.extend(other.escape_debug()),
        }
        if shown.len() > MOST_BYTES {
            shown.truncate(length);
            break;
        }
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn what_a_terminal_would_obey_is_shown() {
        assert_eq!(printable("the door's \"switch\""), "the door's \"switch\"");
        assert_eq!(printable("a\nb\u{1b}[2J"), "a\\nb\\u{1b}[2J");
        assert_eq!(printable("\u{202e}µm\u{7f}"), "\\u{202e}µm\\u{7f}");
        assert_eq!(printable(&"x".repeat(65_519)), "x".repeat(MOST_BYTES));
    }

    proptest! {
        #[test]
        fn any_text_is_short_and_on_one_line(text in any::<String>(), times in 1..64_usize) {
            let shown = printable(&text.repeat(times));
            prop_assert!(shown.len() <= MOST_BYTES);
            prop_assert!(!shown.chars().any(char::is_control));
            prop_assert_eq!(printable(&shown), shown);
        }
    }
}
