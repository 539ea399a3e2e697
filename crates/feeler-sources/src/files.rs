//! A camera that reads image files.

use super::picture::{extensions, is_picture_name, picture_files, read_picture};
use feeler::sensor::image::{Camera, CameraError, Frame, check_frame_size};
use std::path::{Path, PathBuf};

/// Error of a list of image files.
#[derive(Debug, thiserror::Error)]
pub enum FilesError {
    /// A folder or file cannot be read.
    #[error("{}: {source}; expected an image file or a folder of images", path.display())]
    Read {
        /// Path of the file or folder.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// A folder contains no image file.
    #[error("{}: the folder contains no image; expected files ending in {}", path.display(), extensions())]
    Empty {
        /// The folder.
        path: PathBuf,
    },
    /// A file does not have the extension of an image.
    #[error("{}: expected a file ending in {}", path.display(), extensions())]
    UnknownKind {
        /// The file.
        path: PathBuf,
    },
}

/// A camera that reads a list of image files. File k (from 0) is frame k, with the stamp `k / rate`.
///
/// If a file cannot be read or decoded, capturing returns [`CameraError::Unreadable`]; the next call reads the next
/// file.
#[derive(Debug, Clone)]
pub struct PictureFiles {
    files: Vec<PathBuf>,
    size: (usize, usize),
    rate: f64,
    next: usize,
}

impl PictureFiles {
    /// Creates a camera of the images at `paths`, each an image file or a folder of them (in natural order of their
    /// names). The images have `size` (columns, rows) in px and are `1 / rate` seconds apart.
    ///
    /// # Errors
    /// If a folder cannot be read or contains no image, or a file does not have the extension of an image.
    pub fn new(
        paths: &[impl AsRef<Path>],
        size: (usize, usize),
        rate: f64,
    ) -> Result<Self, FilesError> {
        let mut files = Vec::new();
        for path in paths {
            files.extend(files_at(path.as_ref())?);
        }
        Ok(Self {
            files,
            size,
            rate,
            next: 0,
        })
    }
}

fn files_at(path: &Path) -> Result<Vec<PathBuf>, FilesError> {
    let path_buf = path.to_path_buf();
    let failed = |source| FilesError::Read {
        path: path.to_path_buf(),
        source,
    };
    if !std::fs::metadata(path).map_err(failed)?.is_dir() {
        return match is_picture_name(path) {
            true => Ok(vec![path_buf]),
            false => Err(FilesError::UnknownKind { path: path_buf }),
        };
    }
    let files = picture_files(path).map_err(failed)?;
    if files.is_empty() {
        return Err(FilesError::Empty { path: path_buf });
    }
    Ok(files)
}

impl Camera for PictureFiles {
    fn capture(&mut self, frame: &mut Frame) -> Result<(), CameraError> {
        check_frame_size(self.size, frame)?;
        let index = self.next;
        let ended = CameraError::Ended {
            count: index as u64,
        };
        let file = self.files.get(index).ok_or(ended)?;
        self.next += 1;
        let picture = read_picture(file).map_err(|error| CameraError::Unreadable {
            name: file.display().to_string(),
            reason: error.to_string(),
        })?;
        if (picture.width, picture.height) != self.size {
            return Err(CameraError::PictureSize {
                name: file.display().to_string(),
                expected_width: self.size.0,
                expected_height: self.size.1,
                width: picture.width,
                height: picture.height,
            });
        }
        frame.picture = picture;
        frame.sequence = index as u64;
        frame.stamp = index as f64 / self.rate;
        Ok(())
    }
}
