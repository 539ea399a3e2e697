//! Translates type errors of the TOML parser into terms of the file format.

/// Names of types in parser messages, and the terms for them in messages to users.
const TYPES: [(&[&str], &str); 6] = [
    (&["u8"], "a whole number from 0 to 255"),
    (
        &["u16", "u32", "u64", "usize", "i32", "i64"],
        "a whole number",
    ),
    (&["f32", "f64"], "a number"),
    (&["a string", "string"], "text"),
    (&["a boolean", "bool"], "true or false"),
    (&["a map"], "a table"),
];

/// Prefixes of parser messages that describe the actual value, and their replacements in messages to users.
const FOUND: [(&str, &str); 7] = [
    ("invalid type: string ", "the text "),
    ("invalid type: integer ", "the whole number "),
    ("invalid type: floating point ", "the number "),
    ("invalid type: boolean ", "the word "),
    ("invalid type: map", "a table"),
    ("invalid type: sequence", "a list"),
    ("invalid value: integer ", "the whole number "),
];

/// Returns a parser's message without the names of Rust types.
pub(super) fn in_words(message: &str) -> String {
    let lines = message.split('\n').map(line_in_words);
    lines.collect::<Vec<_>>().join("\n")
}

fn line_in_words(line: &str) -> String {
    // Quoted content of the file is not changed.
    let found = FOUND.iter().find(|(parsers, _)| line.starts_with(parsers));
    let (Some((parsers, own)), Some((_, expected))) = (found, line.rsplit_once(", expected "))
    else {
        return line.to_string();
    };
    let value = &line[parsers.len()..line.len() - ", expected ".len() - expected.len()];
    let sign = value.trim_start_matches('`').starts_with('-');
    let types = TYPES.iter().find(|(names, _)| names.contains(&expected));
    let expected = match types {
        Some((_, "a whole number")) if sign => "a whole number, 0 or more",
        Some((_, words)) => words,
        None if expected.starts_with("struct ") => "a table",
        None => expected,
    };
    format!("{own}{value}: expected {expected}")
}

#[cfg(test)]
mod tests {
    use super::in_words;

    #[test]
    fn types_are_translated() {
        let cases = [
            (
                "invalid type: string \"a, expected b\", expected f64",
                "the text \"a, expected b\": expected a number",
            ),
            (
                "invalid type: floating point `1.5`, expected usize",
                "the number `1.5`: expected a whole number",
            ),
            (
                "invalid value: integer `-1`, expected u64",
                "the whole number `-1`: expected a whole number, 0 or more",
            ),
            (
                "invalid type: integer `3`, expected a string",
                "the whole number `3`: expected text",
            ),
            (
                "invalid type: integer `3`, expected struct SensorConfig",
                "the whole number `3`: expected a table",
            ),
            (
                "invalid value: integer `256`, expected u8",
                "the whole number `256`: expected a whole number from 0 to 255",
            ),
            (
                "unknown field `u64`, expected f64",
                "unknown field `u64`, expected f64",
            ),
        ];
        for (parsers, own) in cases {
            let text = format!("TOML parse error at line 1\n{parsers}\n");
            assert_eq!(
                in_words(&text),
                format!("TOML parse error at line 1\n{own}\n")
            );
        }
    }
}
