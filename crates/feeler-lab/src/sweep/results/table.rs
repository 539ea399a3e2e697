//! The table of trials as a CSV file.

use crate::sweep::SweepError;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Table of finished trials.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Column names; the first is `trial`.
    pub header: Vec<String>,
    /// Rows by trial.
    pub rows: BTreeMap<u64, Vec<String>>,
}

impl Table {
    /// Creates an empty table.
    pub fn new(header: Vec<String>) -> Self {
        let rows = BTreeMap::new();
        Self { header, rows }
    }

    /// Reads the text of a file. Every row must be complete, unique, and belong to a trial for which `wanted` returns
    /// `true`.
    ///
    /// # Errors
    /// Describes the first invalid row.
    pub fn parse(
        &mut self,
        path: &Path,
        bytes: &[u8],
        wanted: impl Fn(u64) -> bool,
    ) -> Result<(), SweepError> {
        let wrong = |message: String| SweepError::Folder {
            path: path.to_path_buf(),
            message,
        };
        let mut reader = csv::Reader::from_reader(bytes);
        let header = reader.headers().map_err(|e| wrong(e.to_string()))?;
        if !header.iter().eq(self.header.iter()) {
            return Err(wrong("its columns differ from those of this sweep".into()));
        }
        for (index, record) in reader.records().enumerate() {
            let line = index + 2;
            let record = record.map_err(|e| wrong(e.to_string()))?;
            let trial = record.get(0).and_then(|text| text.parse().ok());
            let trial = trial.filter(|&trial| wanted(trial));
            let trial: u64 = trial.ok_or_else(|| {
                wrong(format!(
                    "line {line}: the trial does not belong to this table"
                ))
            })?;
            let row = record.iter().map(String::from).collect();
            if self.rows.insert(trial, row).is_some() {
                return Err(wrong(format!("trial {trial} occurs twice")));
            }
        }
        Ok(())
    }

    /// Returns the text of the file, sorted by trial.
    pub fn to_csv(&self) -> Vec<u8> {
        let rows = self.rows.values().map(|row| line(row));
        let mut text = line(&self.header);
        text.extend(rows.flatten());
        text
    }

    /// Returns the trials that are in all `tables`.
    pub fn common<'a>(tables: impl IntoIterator<Item = &'a Self>) -> BTreeSet<u64> {
        let trials = tables.into_iter().map(|table| table.rows.keys().copied());
        let trials = trials.map(|trials| trials.collect::<BTreeSet<u64>>());
        trials.reduce(|all, own| &all & &own).unwrap_or_default()
    }

    /// Returns the index of the column with this name.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|column| column == name)
    }

    /// Returns the number of trials and the number of successes.
    pub fn successes(&self) -> (u64, u64) {
        let column = self.column("success");
        let good = |row: &&Vec<String>| column.is_some_and(|c| row[c] == "1");
        let good = self.rows.values().filter(good).count();
        (self.rows.len() as u64, good as u64)
    }
}

/// Returns the fields as one line of the file.
pub fn line(fields: &[String]) -> Vec<u8> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    // Writing a single record to memory cannot fail.
    let _ = writer.write_record(fields);
    writer.into_inner().unwrap_or_default()
}
