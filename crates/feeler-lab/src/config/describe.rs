//! Descriptions of an experiment's values: unit and meaning from the comments of its file, and the required range.

use super::built_in::BUILT_IN;
use super::check::requirements;
use super::load::Experiment;
use std::collections::BTreeMap;
use toml_edit::{DocumentMut, Item, Value};

/// Built-in experiment whose comments are used for keys without a comment.
const REFERENCE: &str = "cap-closing";

/// Description of one value.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ValueDescription {
    /// Unit and meaning, from the comment at the end of its line. Empty if there is no comment.
    pub comment: String,
    /// Requirement on the value, as text. Empty if there is no requirement.
    pub expected: String,
    /// Minimum and maximum, if the requirement is a numeric range.
    pub range: Option<[f64; 2]>,
}

impl Experiment {
    /// Returns the descriptions of all values by dotted key, as in `task.screw.finger.0.home`.
    pub fn described(&self) -> BTreeMap<String, ValueDescription> {
        let mut all = BTreeMap::<String, ValueDescription>::new();
        let reference = BUILT_IN.iter().find(|built_in| built_in.name == REFERENCE);
        let texts = reference.map(|reference| reference.toml);
        for text in texts.into_iter().chain([self.toml.as_str()]) {
            // The text was parsed as TOML when the experiment was loaded.
            let document = text.parse().unwrap_or_else(|_| DocumentMut::new());
            take_comments("", document.as_item(), &mut |key, comment| {
                all.entry(key).or_default().comment = comment;
            });
        }
        for required in requirements(&self.config) {
            let key = required.field.replace('[', ".").replace(']', "");
            let described = all.entry(key).or_default();
            // The first of several requirements is the most informative.
            if described.expected.is_empty() {
                described.expected = required.expected;
                described.range = required.range;
            }
        }
        all
    }
}

/// Calls `take` with the key and the trailing comment of each value below `key` that has a comment.
fn take_comments(key: &str, item: &Item, take: &mut impl FnMut(String, String)) {
    let below = |part: &str| match key {
        "" => part.to_string(),
        key => format!("{key}.{part}"),
    };
    if let Some(table) = item.as_table_like() {
        for (part, item) in table.iter() {
            take_comments(&below(part), item, take);
        }
    } else if let Some(tables) = item.as_array_of_tables() {
        for (place, table) in tables.iter().enumerate() {
            let key = below(&place.to_string());
            take_comments(&key, &Item::Table(table.clone()), take);
        }
    } else if let Some(comment) = item.as_value().and_then(comment) {
        take(key.to_string(), comment);
    }
}

/// Returns the comment after `value` on its line.
fn comment(value: &Value) -> Option<String> {
    let suffix = value.decor().suffix()?.as_str()?;
    let comment = suffix.trim().strip_prefix('#')?.trim();
    Some(comment)
        .filter(|comment| !comment.is_empty())
        .map(str::to_string)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_and_ranges_are_found_by_key() {
        let settings = ["control.slip_threshold=2.5".to_string()];
        let experiment = Experiment::load(REFERENCE, &settings).expect("the reference");
        let described = experiment.described();
        let slip = &described["control.slip_threshold"];
        assert!(slip.comment.starts_with("N/s"), "{slip:?}");
        assert_eq!(slip.range, Some([0.0, feeler::check::MAX]));
        assert_eq!(described["task.screw.strokes"].range, Some([1.0, 1e5]));
        let home = &described["task.screw.finger.1.home"];
        assert_eq!(home.expected, "three numbers from -10 to 10");
    }

    #[test]
    fn comments_of_the_file_take_precedence() {
        let text = BUILT_IN
            .iter()
            .find(|b| b.name == REFERENCE)
            .expect("it")
            .toml;
        let own = text.replacen("# N/s, dr;", "# N/s, of mine;", 1);
        assert_ne!(own, text);
        let experiment = Experiment::parse(&own, "own", &[], None).expect("an experiment");
        let comment = &experiment.described()["control.slip_threshold"].comment;
        assert!(comment.starts_with("N/s, of mine"), "{comment}");
    }
}
