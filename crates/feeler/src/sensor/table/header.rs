//! Column names of a table.

use super::TableError;
use super::unit::name_and_unit;
use std::collections::HashMap;

/// Maximum length of the header in an error message, characters.
const SHOWN: usize = 200;

/// Column names, with lookup by name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Header {
    names: Vec<String>,
    /// Columns by exact name: index of the first one, and number of columns with that name.
    exact: HashMap<String, (usize, usize)>,
    /// Indices of columns by name normalized with [`plain`].
    plain: HashMap<String, Vec<usize>>,
}

impl Header {
    /// Creates a header from the column names.
    pub fn new(names: Vec<String>) -> Self {
        let mut exact = HashMap::new();
        let mut by_plain: HashMap<_, Vec<_>> = HashMap::new();
        for (index, name) in names.iter().enumerate() {
            exact.entry(name.clone()).or_insert((index, 0)).1 += 1;
            by_plain.entry(plain(name)).or_default().push(index);
        }
        Self {
            names,
            exact,
            plain: by_plain,
        }
    }

    /// Column names as in the table.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Index of the column `name`, or `None` if missing. Also matches variants such as `Fx [N]` for `f_x`.
    ///
    /// # Errors
    /// Returns [`TableError::Several`] if several columns match.
    pub fn find(&self, name: &str) -> Result<Option<usize>, TableError> {
        if let Some(&(index, 1)) = self.exact.get(name) {
            return Ok(Some(index));
        }
        match self.plain.get(&plain(name)).map(Vec::as_slice) {
            None | Some([]) => Ok(None),
            Some([index]) => Ok(Some(*index)),
            Some(several) => Err(TableError::Several {
                column: name.to_owned(),
                names: several
                    .iter()
                    .map(|&index| self.names[index].clone())
                    .collect(),
            }),
        }
    }

    /// Unit in the name of the column at `index`, or `None` if it has none.
    pub fn unit(&self, index: usize) -> Option<&str> {
        name_and_unit(self.names.get(index)?).1
    }

    /// Returns the column names on one line for messages, truncated if long.
    pub fn shown(&self) -> String {
        shortened(&self.names.join(","))
    }
}

/// Truncates a long text for messages.
pub fn shortened(text: &str) -> String {
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

/// Normalizes a column name: removes unit, case and word separators, and abbreviates `force` before an axis to `f`, and
/// `torque` and `moment` to `m`.
fn plain(name: &str) -> String {
    let (name, _) = name_and_unit(name);
    let letters = name.chars().filter(|c| !matches!(c, '_' | '-' | '.' | ' '));
    let letters: String = letters.flat_map(char::to_lowercase).collect();
    for (word, letter) in [("force", 'f'), ("torque", 'm'), ("moment", 'm')] {
        if let Some(axis @ ("x" | "y" | "z")) = letters.strip_prefix(word) {
            return format!("{letter}{axis}");
        }
    }
    letters
}

#[cfg(test)]
mod tests {
    use super::*;

    fn find(names: &[&str], name: &str) -> Result<Option<usize>, String> {
        let header = Header::new(names.iter().map(ToString::to_string).collect());
        header.find(name).map_err(|e| e.to_string())
    }

    #[test]
    fn finds_columns_in_all_spellings() {
        for written in [
            "f_x", "Fx", "FX", "fx", "F_X", "f_x [N]", "Fx (mN)", "F_x/N", "Force X", "force_x",
            "f.x", "fx_N",
        ] {
            assert_eq!(find(&["picture", written], "f_x"), Ok(Some(1)), "{written}");
        }
        assert_eq!(find(&["Torque X [Nm]"], "m_x"), Ok(Some(0)));
        assert_eq!(find(&["Picture"], "picture"), Ok(Some(0)));
        assert_eq!(find(&["X-Angle (deg)"], "x_angle"), Ok(Some(0)));
        for other in ["f_xx", "f", "offset_x", "f_x_counts", ""] {
            assert_eq!(find(&[other], "f_x"), Ok(None), "{other}");
        }
    }

    #[test]
    fn rejects_ambiguous_columns() {
        assert_eq!(find(&["Fx", "f_x"], "f_x"), Ok(Some(1)));
        let several = find(&["Fx", "FX"], "f_x").unwrap_err();
        assert_eq!(
            several,
            "columns \"Fx\", \"FX\" may all be f_x; expected one"
        );
        let twice = find(&["f_x", "f_x"], "f_x").unwrap_err();
        assert!(twice.contains("\"f_x\", \"f_x\""), "{twice}");
    }
}
