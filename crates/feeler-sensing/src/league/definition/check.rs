//! Checks the values of a definition.

use super::{
    Definition, DefinitionError, ImageData, Reference, Split, Target, TaxelData, ValuesData,
};
use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};

/// Supported version of the file.
const VERSION: u32 = 1;
/// Range of the number of folds.
const FOLDS: std::ops::RangeInclusive<usize> = 2..=100;
/// Range of the fraction of each recording that is tested.
const PART: std::ops::RangeInclusive<f64> = 0.01..=0.9;
/// Maximum number of targets: wrench calibrations have eight components.
const MAX_TARGETS: usize = 8;

impl Definition {
    /// Checks all values.
    ///
    /// # Errors
    /// If one is invalid.
    pub(super) fn check(&self) -> Result<(), DefinitionError> {
        require(self.version == VERSION, "version", VERSION, self.version)?;
        let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        let named = !self.name.is_empty() && self.name.chars().all(is_plain);
        require(named, "name", "letters, digits, - and _", &self.name)?;
        match self.split {
            Split::Group { folds } | Split::Blocks { folds } => {
                let expected = format!("{} to {}", FOLDS.start(), FOLDS.end());
                require(FOLDS.contains(&folds), "split.folds", expected, folds)?;
            }
            Split::Last { part } => {
                let expected = format!("{} to {}", PART.start(), PART.end());
                require(PART.contains(&part), "split.part", expected, part)?;
            }
        }
        let tables = |given: usize| format!("{given} of them");
        let given = usize::from(self.slip.is_some()) + usize::from(self.values.is_some());
        require(given == 1, "slip, values", "one of them", tables(given))?;
        if let Some(slip) = &self.slip {
            let by_group = matches!(self.split, Split::Group { .. });
            require(
                by_group,
                "split.by",
                "group, because slip has labels by recording",
                "another",
            )?;
            let labels =
                usize::from(slip.labels.is_some()) + usize::from(slip.frame_labels.is_some());
            require(
                labels == 1,
                "slip.labels, slip.frame_labels",
                "one of them",
                tables(labels),
            )?;
        }
        self.values.iter().try_for_each(ValuesData::check)?;
        self.paths().try_for_each(|path| {
            let inside = |part: Component| matches!(part, Component::Normal(_) | Component::CurDir);
            let is_inside = path.components().all(inside);
            require(
                is_inside,
                "a path",
                "a relative path without ..",
                path.display(),
            )
        })
    }

    /// All paths in the definition.
    fn paths(&self) -> impl Iterator<Item = &Path> {
        let slip = self.slip.iter().flat_map(|slip| {
            let paths = [
                Some(&slip.recordings),
                slip.labels.as_ref(),
                slip.layout.as_ref(),
            ];
            let names = slip.tables.iter().chain(&slip.frame_labels).map(Path::new);
            paths
                .into_iter()
                .flatten()
                .map(PathBuf::as_path)
                .chain(names)
        });
        let images = self
            .values
            .iter()
            .filter_map(|values| values.images.as_ref());
        let images = images.flat_map(|images| {
            let files: &[PathBuf] = match &images.reference {
                Reference::Files(files) => files,
                Reference::First(_) => &[],
            };
            [&images.table, &images.folder]
                .into_iter()
                .chain(files)
                .map(PathBuf::as_path)
        });
        let taxels = self
            .values
            .iter()
            .filter_map(|values| values.taxels.as_ref());
        let taxels = taxels.flat_map(|taxels| [&taxels.tables, &taxels.targets].map(Path::new));
        [self.folder.as_path()]
            .into_iter()
            .chain(slip)
            .chain(images)
            .chain(taxels)
    }
}

impl ValuesData {
    fn check(&self) -> Result<(), DefinitionError> {
        let count = self.targets.len();
        let expected = format!("1 to {MAX_TARGETS}");
        require(
            (1..=MAX_TARGETS).contains(&count),
            "values.targets",
            expected,
            count,
        )?;
        let names: BTreeSet<_> = self.targets.iter().map(|target| &target.name).collect();
        require(
            names.len() == count,
            "values.targets",
            "different names",
            "the same",
        )?;
        for Target { factor, .. } in &self.targets {
            let usable = factor.is_finite() && *factor != 0.0;
            require(
                usable,
                "values.targets.factor",
                "a number other than 0",
                factor,
            )?;
        }
        let given = usize::from(self.taxels.is_some()) + usize::from(self.images.is_some());
        let key = "values.taxels, values.images";
        require(given == 1, key, "one of them", format!("{given} of them"))?;
        if let Some(TaxelData {
            tables, targets, ..
        }) = &self.taxels
        {
            for (key, name) in [
                ("values.taxels.tables", tables),
                ("values.taxels.targets", targets),
            ] {
                let stars = name.matches('*').count();
                require(stars <= 1, key, "a name with at most one *", name)?;
            }
            let same = tables.contains('*') == targets.contains('*');
            require(same, "values.taxels.targets", "a * as in tables", targets)?;
        }
        if let Some(ImageData { reference, .. }) = &self.images {
            let enough = match reference {
                Reference::First(count) => *count > 0,
                Reference::Files(files) => !files.is_empty(),
            };
            require(enough, "values.images.reference", "at least one image", 0)?;
        }
        Ok(())
    }
}

fn require(
    is_valid: bool,
    key: &'static str,
    expected: impl ToString,
    actual: impl ToString,
) -> Result<(), DefinitionError> {
    match is_valid {
        true => Ok(()),
        false => Err(DefinitionError::Value {
            key,
            expected: expected.to_string(),
            actual: actual.to_string(),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const VALID: &str = include_str!("../../../league/eflesh-normal.toml");

    proptest! {
        /// Damaged definitions are rejected or valid, without a panic.
        #[test]
        fn damaged_definitions_cause_no_panic(
            edits in proptest::collection::vec((0..VALID.len(), any::<char>()), 1..6), end in 0..2 * VALID.len()
        ) {
            let mut text: Vec<char> = VALID.chars().collect();
            text.truncate(end);
            for (place, new) in edits {
                if let Some(c) = text.get_mut(place) {
                    *c = new;
                }
            }
            let text: String = text.into_iter().collect();
            if let Ok(definition) = Definition::from_toml(&text) {
                prop_assert!(definition.slip.is_some() != definition.values.is_some());
            }
        }
    }
}
