//! The folder of a sweep: its plan and the rows of finished trials, each written to disk at once.

use super::table::{Table, line};
use crate::sweep::SweepError;
use crate::sweep::plan::plan_file::{PLAN, Plan};
use feeler_report::run::create_folder;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Table of a finished sweep.
pub const TRIALS: &str = "trials.csv";
/// Table of an unfinished sweep, in the order in which trials finish.
pub const GROWING: &str = "trials.csv.part";
/// Summary page.
pub const SUMMARY_PAGE: &str = "summary.html";

/// The folder of a sweep, open for appending rows.
pub struct Store {
    folder: PathBuf,
    file: File,
    /// Finished trials.
    pub table: Table,
}

impl Store {
    /// Creates the folder of a new sweep.
    ///
    /// # Errors
    /// If the folder already contains a sweep, or cannot be written.
    pub fn create(folder: &Path, plan: &Plan, header: Vec<String>) -> Result<Self, SweepError> {
        if let Some(old) = [PLAN, TRIALS, GROWING]
            .into_iter()
            .find(|name| folder.join(name).exists())
        {
            return Err(SweepError::Folder {
                path: folder.to_path_buf(),
                message: format!(
                    "the folder already contains a sweep ({old}); expected a new folder, or --resume to continue the sweep"
                ),
            });
        }
        create_folder(folder).map_err(SweepError::file(folder, "nothing was run"))?;
        write_whole(&folder.join(PLAN), plan.to_toml().as_bytes())?;
        let path = folder.join(GROWING);
        let opened = File::create(&path).and_then(|mut file| {
            file.write_all(&line(&header))?;
            Ok(file)
        });
        let file = opened.map_err(SweepError::file(&path, "nothing was run"))?;
        Ok(Self {
            folder: folder.to_path_buf(),
            file,
            table: Table::new(header),
        })
    }

    /// Opens the folder of a stopped sweep. An incomplete last line is removed.
    ///
    /// # Errors
    /// If the existing rows do not belong to this sweep, or the file cannot be read or written.
    pub fn resume(folder: &Path, plan: &Plan, header: Vec<String>) -> Result<Self, SweepError> {
        let mut table = Table::new(header);
        let finished = folder.join(TRIALS);
        let path = folder.join(GROWING);
        let source = if finished.exists() { &finished } else { &path };
        let failed = || SweepError::file(source, "nothing was changed");
        let mut bytes = match fs::read(source) {
            Err(e) if e.kind() == io::ErrorKind::NotFound => Vec::new(),
            read => read.map_err(failed())?,
        };
        drop_torn_line(&mut bytes);
        if bytes.is_empty() {
            bytes = line(&table.header);
        }
        table.parse(source, &bytes, |trial| plan.has(trial))?;
        let opened = if source == &finished {
            File::open(source)
        } else {
            rewind(&path, &bytes)
        };
        let file = opened.map_err(failed())?;
        Ok(Self {
            folder: folder.to_path_buf(),
            file,
            table,
        })
    }

    /// Returns the trials of `plan` below number `end` that are not finished.
    pub fn missing(&self, plan: &Plan, end: u64) -> Vec<u64> {
        (0..plan.trials.min(end))
            .filter(|&trial| plan.shard.has(trial) && !self.table.rows.contains_key(&trial))
            .collect()
    }

    /// Appends the rows of a table with the same columns, as sent by a machine that ran some trials of `plan`.
    ///
    /// # Errors
    /// If the table is invalid or contains an existing row; no row is appended then. If a row cannot be written; the
    /// rows before it are safe.
    pub fn push_table(&mut self, plan: &Plan, text: &[u8]) -> Result<(), SweepError> {
        let path = self.folder.join(GROWING);
        if !text.ends_with(b"\n") {
            return Err(SweepError::Folder {
                path,
                message: "the received rows end within a line; expected complete lines".to_string(),
            });
        }
        let mut table = Table::new(self.table.header.clone());
        let finished = &self.table.rows;
        table.parse(&path, text, |trial| {
            plan.has(trial) && !finished.contains_key(&trial)
        })?;
        for (trial, row) in table.rows {
            self.push(trial, row)?;
        }
        Ok(())
    }

    /// Appends a finished row, which is in the file when this function returns.
    ///
    /// # Errors
    /// If it cannot be written; all earlier rows are safe.
    pub fn push(&mut self, trial: u64, row: Vec<String>) -> Result<(), SweepError> {
        let written = self.file.write_all(&line(&row));
        let finished = self.table.rows.len();
        written.map_err(|e| {
            let note =
                format!("the {finished} finished trials are kept: free disk space and continue with --resume");
            SweepError::file(&self.folder.join(GROWING), note)(e)
        })?;
        self.table.rows.insert(trial, row);
        Ok(())
    }

    /// Writes the sorted table and removes the unsorted one.
    ///
    /// # Errors
    /// If the sorted table cannot be written; the unsorted one is kept then.
    pub fn finish(self) -> Result<Table, SweepError> {
        write_whole(&self.folder.join(TRIALS), &self.table.to_csv())?;
        drop(self.file);
        // Its content is in the sorted table now.
        let _ = fs::remove_file(self.folder.join(GROWING));
        Ok(self.table)
    }
}

/// Truncates or rewrites the file so that it contains exactly `bytes`, and opens it for appending.
fn rewind(path: &Path, bytes: &[u8]) -> io::Result<File> {
    let length = fs::metadata(path).map_or(0, |m| m.len());
    let mut file = OpenOptions::new().create(true).append(true).open(path)?;
    if length < bytes.len() as u64 {
        file.set_len(0)?;
        file.write_all(bytes)?;
    } else {
        file.set_len(bytes.len() as u64)?;
    }
    Ok(file)
}

/// Reads the table of a finished sweep or shard.
///
/// # Errors
/// If there is no table, or it does not belong to this plan.
pub fn read_finished(folder: &Path, plan: &Plan, table: &mut Table) -> Result<(), SweepError> {
    let whole = folder.join(TRIALS);
    let path = if whole.exists() {
        whole
    } else {
        folder.join(GROWING)
    };
    let read = fs::read(&path);
    let mut bytes = read.map_err(SweepError::file(&path, "expected a sweep's rows"))?;
    drop_torn_line(&mut bytes);
    table.parse(&path, &bytes, |trial| plan.has(trial))
}

/// Removes an incomplete last line.
fn drop_torn_line(bytes: &mut Vec<u8>) {
    let end = bytes.iter().rposition(|&byte| byte == b'\n');
    bytes.truncate(end.map_or(0, |end| end + 1));
}

/// Writes a file atomically.
///
/// # Errors
/// If it cannot be written.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), SweepError> {
    let mut part = path.as_os_str().to_owned();
    part.push(".new");
    let part = PathBuf::from(part);
    let written = File::create(&part).and_then(|mut file| {
        file.write_all(bytes)?;
        file.sync_all()
    });
    written.and_then(|()| fs::rename(&part, path)).map_err(|e| {
        // Remove the temporary file.
        let _ = fs::remove_file(&part);
        SweepError::file(path, "finished trials are kept")(e)
    })
}
