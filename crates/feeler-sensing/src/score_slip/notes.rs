//! What was odd: of each kind the first few are said, and how many more there were.

use feeler_console::warn;

/// How many of a kind are said.
const SAID: usize = 4;

/// Kinds of oddities, in the order in which they came.
#[derive(Debug, Default)]
pub struct Notes(Vec<Note>);

#[derive(Debug, Default)]
struct Note {
    kind: String,
    /// What is said of the first.
    said: Vec<String>,
    /// How many more there were.
    more: usize,
}

impl Notes {
    /// Adds one of a `kind`, of which this is to be said if it is one of the first.
    pub fn add(&mut self, kind: &str, sentence: impl FnOnce() -> String) {
        let place = self.0.iter().position(|note| note.kind == kind);
        let place = place.unwrap_or_else(|| {
            self.0.push(Note {
                kind: kind.to_owned(),
                ..Note::default()
            });
            self.0.len() - 1
        });
        if let Some(note) = self.0.get_mut(place) {
            match note.said.len() < SAID {
                true => note.said.push(sentence()),
                false => note.more += 1,
            }
        }
    }

    /// Adds all of `others`, which came after these.
    pub fn extend(&mut self, others: Self) {
        for Note { kind, said, more } in others.0 {
            for sentence in said {
                self.add(&kind, || sentence);
            }
            // There are more than are said of those kinds only of which enough was said.
            if let Some(note) = self.0.iter_mut().find(|note| note.kind == kind) {
                note.more += more;
            }
        }
    }

    /// What is said, sentence by sentence.
    pub fn sentences(&self) -> Vec<String> {
        let sentences = self.0.iter().flat_map(|note| {
            let last = note.said.len().saturating_sub(1);
            let said = note.said.iter().enumerate();
            said.map(move |(index, sentence)| match note.more {
                more if more > 0 && index == last => {
                    format!("{sentence} (and {more} more)")
                }
                _ => sentence.clone(),
            })
        });
        sentences.collect()
    }

    /// Says all of it on standard error.
    pub fn tell(&self) {
        for sentence in self.sentences() {
            warn(&sentence);
        }
    }
}
