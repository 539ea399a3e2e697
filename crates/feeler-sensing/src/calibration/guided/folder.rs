//! What was taken live, on disk: pictures and their table, to which is added as they come.

use feeler::sensor::frame::Picture;
use feeler_console::CommandError;
use feeler_console::cut_torn_line;
use feeler_report::make::create_folder;
use image::{ExtendedColorType, ImageFormat};
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};

/// The folder.
pub struct Folder {
    path: PathBuf,
    table: PathBuf,
    rows: File,
    /// Pictures in it; the next one has this number.
    pictures: usize,
}

impl Folder {
    /// Opens the folder, or makes it, with the table of this name and these columns; whether there are rows in it.
    ///
    /// # Errors
    /// When it cannot be written to, or holds something else.
    pub fn open(path: &Path, table: &str, columns: &str) -> Result<(Self, bool), CommandError> {
        let failed = |e: &dyn std::fmt::Display| {
            let path = path.display();
            format!("{path}: {e}; expected a new folder, or one of an earlier --live")
        };
        create_folder(path).map_err(|e| failed(&e))?;
        let name = table;
        let table = path.join(name);
        let is_new = !table.exists();
        let mut has_rows = false;
        if !is_new {
            // Killed while it was written.
            cut_torn_line(&table).map_err(|e| failed(&e))?;
            let text = fs::read_to_string(&table).map_err(|e| failed(&e))?;
            has_rows = text.lines().nth(1).is_some();
        } else if fs::read_dir(path).map_err(|e| failed(&e))?.next().is_some() {
            return Err(failed(&format!("it is not empty, and has no {name}")).into());
        }
        let rows = File::options().create(true).append(true).open(&table);
        let mut rows = rows.map_err(|e| failed(&e))?;
        if is_new {
            writeln!(rows, "{columns}").map_err(|e| failed(&e))?;
        }
        let folder = Self {
            path: path.into(),
            table,
            rows,
            pictures: 0,
        };
        Ok((folder, has_rows))
    }

    /// The table.
    pub fn table(&self) -> &Path {
        &self.table
    }

    /// Number of pictures in it.
    pub fn pictures(&self) -> usize {
        self.pictures
    }

    /// Takes note of pictures that were there before.
    pub fn count(&mut self, pictures: usize) {
        self.pictures += pictures;
    }

    /// Adds a picture, and the row that begins with its name and goes on with `values`.
    pub fn add(&mut self, picture: &Picture, values: &str) -> Result<(), CommandError> {
        let name = self.save(picture)?;
        // In one piece, so that only the system can tear it.
        let written = self.rows.write_all(format!("{name},{values}\n").as_bytes());
        written.map_err(|e| format!("{}: {e}", self.table.display()).into())
    }

    /// Writes a picture under the next name that is free: one whose row was not written any more is in the way of none.
    fn save(&mut self, picture: &Picture) -> Result<String, CommandError> {
        let (name, path) = loop {
            let name = format!("{:05}.png", self.pictures);
            self.pictures += 1;
            let path = self.path.join(&name);
            if !path.exists() {
                break (name, path);
            }
        };
        let (width, height) = (picture.width as u32, picture.height as u32);
        let (gray, png) = (ExtendedColorType::L8, ImageFormat::Png);
        image::save_buffer_with_format(&path, &picture.pixels, width, height, gray, png)
            .map_err(|e| format!("{}: {e}", path.display()))?;
        Ok(name)
    }
}
