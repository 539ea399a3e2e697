//! Comparison of the output that a page of the documentation quotes with the printed output.

use std::collections::BTreeSet;

/// Lines of the code blocks in `language` on a `page`.
pub fn blocks(page: &'static str, language: &str) -> impl Iterator<Item = &'static str> {
    let begin = format!("```{language}\n");
    let blocks: Vec<_> = page.split(begin.as_str()).skip(1).collect();
    let bodies = blocks
        .into_iter()
        .filter_map(|block| block.split_once("\n```"));
    bodies.flat_map(|(body, _)| body.lines())
}

/// Printed lines, with numbers and the name of the port replaced.
#[derive(Default)]
pub struct Printed(BTreeSet<String>);

impl Printed {
    /// Adds the output of a program.
    pub fn add(&mut self, text: &str) {
        self.0.extend(text.lines().map(without_numbers));
    }

    /// Asserts that every line that a page shows was printed.
    pub fn check(&self, shown: impl Iterator<Item = &'static str>) {
        for line in shown.filter(|line| !line.is_empty()) {
            let was_printed = self.0.contains(&without_numbers(line));
            assert!(was_printed, "{line:?} was not printed: {:#?}", self.0);
        }
    }
}

fn without_numbers(line: &str) -> String {
    let mut shape = String::new();
    let mut words = line.trim_end().split(' ').peekable();
    while let Some(word) = words.next() {
        let is_port = word.contains("/dev/pts/") || word.contains("/dev/ttyUSB0");
        let digits = |c: char| c.is_ascii_digit() || matches!(c, '.' | '-' | '+');
        match is_port {
            true => shape.push_str("PORT"),
            false => {
                let mut is_number = false;
                for c in word.chars() {
                    match digits(c) && word.chars().any(|c| c.is_ascii_digit()) {
                        true if is_number => {}
                        true => shape.push('#'),
                        false => shape.push(c),
                    }
                    is_number = digits(c);
                }
            }
        }
        if words.peek().is_some() {
            shape.push(' ');
        }
    }
    shape
}
