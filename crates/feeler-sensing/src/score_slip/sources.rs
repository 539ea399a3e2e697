//! Finds recordings.

use super::notes::Notes;
use feeler::control::grasp_slip::CoarseImage;
use feeler_console::CommandError;
use feeler_lab::grasps::GraspRecording;
use feeler_sources::is_video_name;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

/// File type of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A table, compressed or not.
    Table,
    /// A video.
    Video,
}

/// File name extensions of tables, in lower case.
const TABLES: [&str; 2] = [".csv", ".csv.gz"];

/// Location of one recording, or of several in one table.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// Name of the folder or file.
    pub name: String,
    /// Folder of the recording, if it has a separate one.
    pub folder: Option<PathBuf>,
    /// Paths of its tables, or of its video.
    pub tables: Vec<PathBuf>,
}

impl Source {
    fn file(path: &Path) -> Self {
        let name = path.file_name().unwrap_or(OsStr::new(""));
        Self {
            name: name.to_string_lossy().into_owned(),
            folder: None,
            tables: vec![path.to_owned()],
        }
    }

    /// File type of the recording: a table unless the file has a video's extension.
    pub fn kind(&self) -> Kind {
        match self.folder {
            None if is_video_name(Path::new(&self.name)) => Kind::Video,
            _ => Kind::Table,
        }
    }

    /// Name without the file extension (`.csv`, `.csv.gz`).
    pub fn stem(&self) -> &str {
        if self.folder.is_some() {
            return &self.name;
        }
        let name = self.name.strip_suffix(".gz").unwrap_or(&self.name);
        name.rsplit_once('.').map_or(name, |(stem, _)| stem)
    }
}

/// A recording that has been read.
pub struct Read {
    /// Names under which labels may list the recording, the primary one first.
    pub names: Vec<String>,
    pub recording: GraspRecording,
    /// Image of each frame; empty for tables.
    pub images: Vec<CoarseImage>,
}

/// Finds the recordings at `path`.
///
/// A file is a recording. In a folder, each table and video is one or, if `tables` are named, each subfolder with any
/// of these tables. Files in `others` are excluded.
///
/// # Errors
/// If no recordings are found, or the folder cannot be read.
pub fn find(
    path: &Path,
    tables: &[String],
    others: &[&Path],
    notes: &mut Notes,
) -> Result<Vec<Source>, CommandError> {
    let refused = |what: &str| -> CommandError { format!("{}: {what}", path.display()).into() };
    let there = fs::metadata(path);
    let there =
        there.map_err(|e| refused(&format!("{e}; expected recordings, a file or a folder")))?;
    if !there.is_dir() {
        return match tables {
            [] => Ok(vec![Source::file(path)]),
            _ => Err(refused(
                "expected a folder with one subfolder per recording (--table), got a file",
            )),
        };
    }
    let entries = fs::read_dir(path).map_err(|e| refused(&e.to_string()))?;
    let mut entries: Vec<_> = (entries.filter_map(Result::ok)).map(|e| e.path()).collect();
    entries.sort();
    let others: Vec<_> = others
        .iter()
        .filter_map(|other| other.canonicalize().ok())
        .collect();
    let is_other = |path: &Path| path.canonicalize().is_ok_and(|path| others.contains(&path));
    let found: Vec<_> = match tables {
        [] => (entries.iter())
            .filter(|path| path.is_file() && is_recording(path) && !is_other(path))
            .map(|path| Source::file(path))
            .collect(),
        _ => (entries.iter())
            .filter_map(|folder| in_folder(folder, tables, notes))
            .collect(),
    };
    if found.is_empty() {
        return Err(refused(&match tables {
            [] => "no recording found; expected files ending in .csv, .csv.gz, .avi, .mp4, .mkv, .mov, .webm or .m4v, or --table for recordings in separate folders".into(),
            _ => format!("no subfolder contains {}", tables.join(" or ")),
        }));
    }
    Ok(found)
}

fn in_folder(folder: &Path, tables: &[String], notes: &mut Notes) -> Option<Source> {
    let paths: Vec<_> = tables.iter().map(|table| folder.join(table)).collect();
    let name = folder.file_name()?.to_string_lossy().into_owned();
    if !paths.iter().any(|path| path.is_file()) {
        return None;
    }
    if let Some(missing) = paths.iter().find(|path| !path.is_file()) {
        notes.add("table", || {
            format!("{} not found; {name} skipped", missing.display())
        });
        return None;
    }
    Some(Source {
        name,
        folder: Some(folder.to_owned()),
        tables: paths,
    })
}

fn is_recording(path: &Path) -> bool {
    let name = path.file_name().unwrap_or(OsStr::new(""));
    let name = name.to_string_lossy().to_ascii_lowercase();
    is_video_name(path) || TABLES.iter().any(|ending| name.ends_with(ending))
}
