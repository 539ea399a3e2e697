//! What was taken live, on disk: pictures and their LOADS.csv, to which is added as they come.

use super::super::CommandError;
use crate::part_file::cut_torn_line;
use feeler::sensor::frame::Picture;
use feeler::sensor::live_calibration::{Coverage, Goal};
use feeler::sensor::loads::{COLUMNS, PLACE_COLUMNS};
use feeler::sensor::seen::SeenElement;
use feeler_lab::sensor::{LoadsFile, SensorGeometry};
use glam::{DVec2, DVec3};
use image::{ExtendedColorType, ImageFormat};
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Name of the file of loads.
pub const LOADS: &str = "LOADS.csv";

/// The folder.
pub struct Folder {
    path: PathBuf,
    loads: File,
    seen: Vec<SeenElement>,
    coverage: Vec<Coverage>,
    /// Pictures in it; the next one has this number.
    pictures: usize,
}

impl Folder {
    /// Opens the folder, or makes it; what is known of each element by what is in it.
    ///
    /// # Errors
    /// When it cannot be written to, holds something else, or what was taken of another sensor.
    pub fn open(path: &Path, sensor: &SensorGeometry, goal: &Goal) -> Result<Self, CommandError> {
        let failed = |e: &dyn std::fmt::Display| {
            let path = path.display();
            format!("{path}: {e}; expected a new folder, or one of an earlier --live")
        };
        fs::create_dir_all(path).map_err(|e| failed(&e))?;
        let csv = path.join(LOADS);
        let mut coverage = vec![Coverage::default(); sensor.seen.len()];
        let mut pictures = 0;
        if csv.exists() {
            // Killed while it was written.
            cut_torn_line(&csv).map_err(|e| failed(&e))?;
            let loads = LoadsFile::read(&csv, &sensor.seen)?;
            pictures = loads.picture_count();
            loads.each_force(|element, force| {
                coverage[element].count(force, goal);
            });
        } else if fs::read_dir(path).map_err(|e| failed(&e))?.next().is_some() {
            return Err(failed(&"it is not empty, and has no LOADS.csv").into());
        }
        let is_new = !csv.exists();
        let loads = File::options().create(true).append(true).open(&csv);
        let mut loads = loads.map_err(|e| failed(&e))?;
        if is_new {
            let columns: Vec<&str> = COLUMNS.iter().chain(&PLACE_COLUMNS).copied().collect();
            writeln!(loads, "{}", columns.join(",")).map_err(|e| failed(&e))?;
        }
        Ok(Self {
            path: path.into(),
            loads,
            seen: sensor.seen.clone(),
            coverage,
            pictures,
        })
    }

    /// What was known of each element when it was opened.
    pub fn coverage(&self) -> Vec<Coverage> {
        self.coverage.clone()
    }

    /// Number of pictures in it.
    pub fn pictures(&self) -> usize {
        self.pictures
    }

    /// Adds a picture without load.
    pub fn untouched(&mut self, picture: &Picture) -> Result<(), CommandError> {
        let name = self.save(picture)?;
        self.row(&format!("{name},,0,0,0,,,"))
    }

    /// Adds a picture with a force on an element, N, in its frame.
    pub fn sample(
        &mut self,
        picture: &Picture,
        element: usize,
        force: DVec3,
    ) -> Result<(), CommandError> {
        let name = self.save(picture)?;
        let DVec3 { x, y, z } = force;
        let seen = self.seen[element];
        let (DVec2 { x: column, y: row }, angle) = (seen.centre_px, seen.x_angle);
        self.row(&format!(
            "{name},{element},{x},{y},{z},{column},{row},{angle}"
        ))
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

    /// Adds a row in one piece, so that only the system can tear it.
    fn row(&mut self, row: &str) -> Result<(), CommandError> {
        let written: io::Result<()> = self.loads.write_all(format!("{row}\n").as_bytes());
        written.map_err(|e| format!("{}: {e}", self.path.join(LOADS).display()).into())
    }
}
