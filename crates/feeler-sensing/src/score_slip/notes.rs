//! Collects notes about irregular data. The first few of each kind are printed, and the others are counted.

use feeler_console::warn;

/// Maximum number of notes of one kind that are printed.
const SAID: usize = 4;

/// Notes by kind, in order of first occurrence.
#[derive(Debug, Default)]
pub struct Notes(Vec<Note>);

#[derive(Debug, Default)]
struct Note {
    kind: String,
    /// The first notes.
    said: Vec<String>,
    /// Number of notes that are counted but not printed.
    more: usize,
}

impl Notes {
    /// Adds a note of this `kind`. `sentence` is called only if the note will be printed.
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

    /// Appends the notes of `others`.
    pub fn extend(&mut self, others: Self) {
        for Note { kind, said, more } in others.0 {
            for sentence in said {
                self.add(&kind, || sentence);
            }
            // `more` is only positive if the maximum number of notes is already stored.
            if let Some(note) = self.0.iter_mut().find(|note| note.kind == kind) {
                note.more += more;
            }
        }
    }

    /// Returns the notes to be printed.
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

    /// Prints the notes as warnings on standard error.
    pub fn tell(&self) {
        for sentence in self.sentences() {
            warn(&sentence);
        }
    }
}
