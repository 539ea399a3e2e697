//! Sanitizing of texts from other programs for display and recording.

/// Maximum length of a sanitized text, in bytes.
pub const MAX_BYTES: usize = 256;

/// Returns `text` on one line, truncated to [`MAX_BYTES`]. Control characters, escape sequences and changes of text
/// direction are escaped, as in `\n` or `\u{1b}`.
pub fn printable(text: &str) -> String {
    let mut shown = String::with_capacity(text.len().min(MAX_BYTES));
    for character in text.chars() {
        let length = shown.len();
        match character {
            // Harmless, and leaving them unescaped makes the function idempotent.
            '"' | '\'' | '\\' => shown.push(character),
            other => shown.extend(other.escape_debug()),
        }
        if shown.len() > MAX_BYTES {
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
    fn control_characters_are_escaped() {
        assert_eq!(printable("the door's \"switch\""), "the door's \"switch\"");
        assert_eq!(printable("a\nb\u{1b}[2J"), "a\\nb\\u{1b}[2J");
        assert_eq!(printable("\u{202e}µm\u{7f}"), "\\u{202e}µm\\u{7f}");
        assert_eq!(printable(&"x".repeat(65_519)), "x".repeat(MAX_BYTES));
    }

    proptest! {
        #[test]
        fn any_text_is_short_and_on_one_line(text in any::<String>(), times in 1..64_usize) {
            let shown = printable(&text.repeat(times));
            prop_assert!(shown.len() <= MAX_BYTES);
            prop_assert!(!shown.chars().any(char::is_control));
            prop_assert_eq!(printable(&shown), shown);
        }
    }
}
