//! Messages between the league and a program: one JSON object per line (docs/league.md).

use super::order::Order;
use crate::league::data::{DataSet, Fold, Piece, Truth};
use crate::league::definition::Target;
use serde::{Deserialize, Serialize};
use std::io::Write;

/// Version of the messages.
const VERSION: u32 = 1;
/// Maximum length of an answer in addition to its numbers (bytes).
const LINE: usize = 4096;
/// Maximum length of each number of an answer (bytes).
const NUMBER: usize = 64;
/// Maximum number of characters of a wrong answer that are shown.
const SHOWN: usize = 80;

/// First line to a program.
#[derive(Serialize)]
struct Header<'a> {
    protocol: &'static str,
    version: u32,
    set: &'a str,
    /// `slip` or `values`.
    task: &'static str,
    /// `recording` or `row`: number of answers per recording.
    per: &'static str,
    fold: usize,
    folds: usize,
    columns: &'a [&'static str],
    unit: &'a str,
    targets: Vec<Named<'a>>,
    train: usize,
    test: usize,
}

#[derive(Serialize)]
struct Named<'a> {
    name: &'a str,
    unit: &'a str,
}

/// A piece of a recording, sent as one line. Lines for training contain the truth.
#[derive(Serialize)]
struct Sample<'a> {
    sample: usize,
    part: &'static str,
    recording: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    group: Option<usize>,
    times: &'a [f64],
    values: &'a [Vec<f64>],
    #[serde(skip_serializing_if = "Option::is_none")]
    slip: Option<Labels<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    targets: Option<&'a [Vec<f64>]>,
}

#[derive(Serialize)]
#[serde(untagged)]
enum Labels<'a> {
    One(bool),
    Rows(&'a [Option<bool>]),
}

/// An answer of a program: one line.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Answer {
    sample: usize,
    slip: Option<Numbers>,
    targets: Option<Vec<Vec<f64>>>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Numbers {
    One(f64),
    Rows(Vec<f64>),
}

/// A fold of a data set, as sent to a program.
pub struct Question<'a> {
    pub name: &'a str,
    pub set: &'a DataSet,
    pub targets: &'a [Target],
    pub fold: &'a Fold,
    pub order: &'a Order,
    /// Index of the fold, and number of folds.
    pub number: (usize, usize),
}

impl Question<'_> {
    /// Writes all lines.
    ///
    /// # Errors
    /// If the program does not read them.
    pub fn write(&self, out: &mut impl Write) -> std::io::Result<()> {
        let per_row = |r: &crate::league::data::Recording| !matches!(r.truth, Truth::Slip(_));
        let named = |target: &Target| (target.name.clone(), target.unit.clone());
        let named: Vec<_> = self.targets.iter().map(named).collect();
        let header = Header {
            protocol: "feeler-league",
            version: VERSION,
            set: self.name,
            task: if self.targets.is_empty() {
                "slip"
            } else {
                "values"
            },
            per: if self.set.recordings.iter().any(per_row) {
                "row"
            } else {
                "recording"
            },
            fold: self.number.0,
            folds: self.number.1,
            columns: self.set.columns,
            unit: &self.set.unit,
            targets: named
                .iter()
                .map(|(name, unit)| Named { name, unit })
                .collect(),
            train: self.order.train.len(),
            test: self.order.test.len(),
        };
        line(&header, out)?;
        for (number, piece) in self.order.train.iter().enumerate() {
            line(&self.sample(number, piece, true), out)?;
        }
        for (number, &index) in self.order.test.iter().enumerate() {
            line(&self.sample(number, &self.fold.test[index], false), out)?;
        }
        Ok(())
    }

    fn sample(&self, sample: usize, piece: &Piece, train: bool) -> Sample<'_> {
        let recording = &self.set.recordings[piece.recording];
        let rows = piece.rows.clone();
        let (mut slip, mut targets) = (None, None);
        match &recording.truth {
            _ if !train => {}
            Truth::Slip(slipped) => slip = Some(Labels::One(*slipped)),
            Truth::SlipRows(labels) => slip = Some(Labels::Rows(&labels[rows.clone()])),
            Truth::Values(values) => targets = Some(&values[rows.clone()]),
        }
        Sample {
            sample,
            part: if train { "train" } else { "test" },
            recording: self.order.recordings[piece.recording],
            group: train.then(|| self.order.groups[recording.group]),
            times: &recording.times[rows.clone()],
            values: &recording.rows[rows],
            slip,
            targets,
        }
    }

    /// Maximum length of an answer (bytes).
    pub fn longest(&self) -> usize {
        let rows = self.fold.test.iter().map(|piece| piece.rows.len()).max();
        LINE + NUMBER * rows.unwrap_or(0) * self.targets.len().max(1)
    }

    /// Parses `text`, the answer to the test piece with this `number` in the order of sending: rows of numbers, or one
    /// row for a whole recording.
    ///
    /// # Errors
    /// Returns what was expected if the answer is something else.
    pub fn parse(&self, number: usize, text: &[u8]) -> Result<Vec<Vec<f64>>, String> {
        let shown = || {
            let text = String::from_utf8_lossy(text);
            let text = text.trim();
            match text.char_indices().nth(SHOWN) {
                Some((end, _)) => format!("{:?}…", &text[..end]),
                None => format!("{text:?}"),
            }
        };
        let expected = |what: &str| format!("expected {what}, got {}", shown());
        let answer: Answer = serde_json::from_slice(text)
            .map_err(|error| format!("{} ({error})", expected("an answer in JSON")))?;
        if answer.sample != number {
            return Err(expected(&format!("the answer to sample {number}")));
        }
        let piece = &self.fold.test[self.order.test[number]];
        let rows = piece.rows.len();
        match (&self.set.recordings[piece.recording].truth, answer) {
            (
                Truth::Values(_),
                Answer {
                    targets: Some(targets),
                    slip: None,
                    ..
                },
            ) => {
                let count = self.targets.len();
                let is_whole =
                    targets.len() == rows && targets.iter().all(|row| row.len() == count);
                let what = format!("targets with {rows} rows of {count} numbers");
                if is_whole {
                    Ok(targets)
                } else {
                    Err(expected(&what))
                }
            }
            (Truth::Values(_), _) => Err(expected("targets")),
            (
                truth,
                Answer {
                    slip: Some(slip),
                    targets: None,
                    ..
                },
            ) => {
                let (found, count) = match (truth, slip) {
                    (Truth::Slip(_), Numbers::One(slip)) => (vec![slip], 1),
                    (Truth::SlipRows(_), Numbers::Rows(slips)) => (slips, rows),
                    (Truth::Slip(_), _) => return Err(expected("slip as one number")),
                    _ => return Err(expected(&format!("slip as {rows} numbers"))),
                };
                let is_share = found.iter().all(|slip| (0.0..=1.0).contains(slip));
                match found.len() == count && is_share {
                    true => Ok(found.into_iter().map(|slip| vec![slip]).collect()),
                    false => Err(expected(&format!(
                        "{count} probabilities of slip from 0 to 1"
                    ))),
                }
            }
            _ => Err(expected("slip")),
        }
    }
}

fn line(message: &impl Serialize, out: &mut impl Write) -> std::io::Result<()> {
    serde_json::to_writer(&mut *out, message)?;
    out.write_all(b"\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::league::data::Recording;
    use proptest::prelude::*;

    /// A fold that tests one recording of three rows with this truth.
    fn with_question<R>(truth: Truth, targets: usize, ask: impl FnOnce(&Question) -> R) -> R {
        let set = DataSet {
            columns: &["x"],
            unit: "px".into(),
            recordings: vec![Recording {
                name: "a".into(),
                group: 0,
                times: vec![0.0, 1.0, 2.0],
                rows: vec![vec![1.0], vec![f64::NAN], vec![3.0]],
                truth,
            }],
            groups: vec!["a".into()],
            slips: Vec::new(),
            digest: String::new(),
            notes: Vec::new(),
        };
        let piece = Piece {
            recording: 0,
            rows: 0..3,
        };
        let fold = Fold {
            train: Vec::new(),
            test: vec![piece],
        };
        let target: Target = toml::from_str("name = 'f'\ncolumn = 'f'\nunit = 'N'").unwrap();
        let order = Order::of(&set, &fold);
        ask(&Question {
            name: "set",
            set: &set,
            targets: &vec![target; targets],
            fold: &fold,
            order: &order,
            number: (0, 1),
        })
    }

    #[test]
    fn unknown_values_are_null() {
        let text = with_question(Truth::Slip(true), 0, |question| {
            let mut text = Vec::new();
            question.write(&mut text).unwrap();
            String::from_utf8(text).unwrap()
        });
        let last = text.lines().last().unwrap();
        let expected = r#"{"sample":0,"part":"test","recording":0,"times":[0.0,1.0,2.0],"values":[[1.0],[null],[3.0]]}"#;
        assert_eq!(last, expected);
    }

    #[test]
    fn answers_must_fit_the_question() {
        let whole =
            |text: &str| with_question(Truth::Slip(true), 0, |q| q.parse(0, text.as_bytes()));
        let rows = |text: &str| {
            with_question(Truth::SlipRows(vec![None; 3]), 0, |q| {
                q.parse(0, text.as_bytes())
            })
        };
        let values = |text: &str| {
            with_question(Truth::Values(vec![vec![0.0]; 3]), 1, |q| {
                q.parse(0, text.as_bytes())
            })
        };
        assert_eq!(whole(r#"{"sample":0,"slip":0.5}"#), Ok(vec![vec![0.5]]));
        assert_eq!(
            rows(r#"{"sample":0,"slip":[0,0.5,1]}"#).map(|rows| rows.len()),
            Ok(3)
        );
        assert_eq!(
            values(r#"{"sample":0,"targets":[[1],[2],[3e9]]}"#).map(|rows| rows.len()),
            Ok(3)
        );
        for text in [
            "",
            "{}",
            "0.5",
            r#"{"sample":1,"slip":0.5}"#,
            r#"{"sample":0,"slip":1.5}"#,
            r#"{"sample":0,"slip":null}"#,
            r#"{"sample":0,"slip":[0.5]}"#,
            r#"{"sample":0,"slip":1e999}"#,
            r#"{"sample":0,"targets":[[1],[2],[3]]}"#,
            r#"{"sample":0,"slip":0.5,"more":1}"#,
            r#"{"sample":0,"slip":0.5,"targets":[]}"#,
            r#"{"sample":0,"slip":NaN}"#,
        ] {
            let error = whole(text).unwrap_err();
            assert!(error.starts_with("expected "), "{error}");
        }
        for text in [
            r#"{"sample":0,"slip":[0,1]}"#,
            r#"{"sample":0,"slip":[0,1,-0.1]}"#,
            r#"{"sample":0,"slip":0.5}"#,
        ] {
            rows(text).unwrap_err();
        }
        for text in [
            r#"{"sample":0,"targets":[[1],[2]]}"#,
            r#"{"sample":0,"targets":[[1],[2],[3,4]]}"#,
            r#"{"sample":0,"targets":[[1],[2],[null]]}"#,
            r#"{"sample":0,"slip":[0,0,0]}"#,
        ] {
            values(text).unwrap_err();
        }
    }

    proptest! {
        #[test]
        fn any_answer_is_parsed_without_a_panic(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
            let parsed = with_question(Truth::Slip(false), 0, |question| question.parse(0, &bytes));
            prop_assert!(parsed.is_err());
        }
    }
}
