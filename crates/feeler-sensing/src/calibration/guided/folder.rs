//! Folder of images recorded live, with a table that grows by one row per image.

use feeler::sensor::image::Picture;
use feeler_console::{CommandError, cut_torn_line};
use feeler_report::run::make::create_folder;
use image::{ExtendedColorType, ImageFormat};
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};

/// An open folder and its table.
pub struct Folder {
    path: PathBuf,
    table: PathBuf,
    rows: File,
    /// Number of images; also the number of the next one.
    pictures: usize,
}

impl Folder {
    /// Opens or creates the folder with a table of the given name and columns; returns `true` if the table has rows.
    ///
    /// # Errors
    /// If the folder is not writable, or contains other files and no such table.
    pub fn open(path: &Path, table: &str, columns: &str) -> Result<(Self, bool), CommandError> {
        let failed = |e: &dyn std::fmt::Display| {
            let path = path.display();
            format!("{path}: {e}; expected a new folder, or the folder of an earlier --live")
        };
        create_folder(path).map_err(|e| failed(&e))?;
        let name = table;
        let table = path.join(name);
        let is_new = !table.exists();
        let mut has_rows = false;
        if !is_new {
            // The program may have been killed while writing.
            cut_torn_line(&table).map_err(|e| failed(&e))?;
            let text = fs::read_to_string(&table).map_err(|e| failed(&e))?;
            has_rows = text.lines().nth(1).is_some();
        } else if fs::read_dir(path).map_err(|e| failed(&e))?.next().is_some() {
            return Err(failed(&format!("the folder is not empty and contains no {name}")).into());
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

    /// Returns the path of the table.
    pub fn table(&self) -> &Path {
        &self.table
    }

    /// Returns the number of images.
    pub fn pictures(&self) -> usize {
        self.pictures
    }

    /// Adds images of an earlier session to the count.
    pub fn count(&mut self, pictures: usize) {
        self.pictures += pictures;
    }

    /// Saves an image, and appends a row with its file name and `values`.
    pub fn add(&mut self, picture: &Picture, values: &str) -> Result<(), CommandError> {
        let name = self.save(picture)?;
        // A single write, so that only a crash of the system can tear the row.
        let written = self.rows.write_all(format!("{name},{values}\n").as_bytes());
        written.map_err(|e| format!("{}: {e}", self.table.display()).into())
    }

    /// Saves an image under the next free name. An existing file may lack its row if an earlier session was killed.
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
