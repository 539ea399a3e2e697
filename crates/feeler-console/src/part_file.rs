//! Output files: they never replace an input, replace an existing file only if forced, and get their final name only
//! when complete.

use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Maximum length of a table row (bytes). The last line feed is searched for within this distance from the end.
const MAX_ROW: u64 = 1 << 20;

/// Error of creating or completing an output file.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// The path must not be written to.
    #[error("{argument} {path}: {problem}")]
    Refused {
        /// Command-line option that specifies the path.
        argument: &'static str,
        /// The path.
        path: PathBuf,
        /// The problem and the expected input.
        problem: String,
    },
    /// The file cannot be written.
    #[error("{argument} {path}: {error}; expected a file in a writable folder")]
    Io {
        /// Command-line option that specifies the path.
        argument: &'static str,
        /// The path.
        path: PathBuf,
        /// Cause.
        error: io::Error,
    },
    /// Only a part of the file was written.
    #[error("{cause}; {part} is partial")]
    Partial {
        /// Cause.
        cause: Box<OutputError>,
        /// Path of the partial file.
        part: PathBuf,
    },
}

/// The output files of one command, checked against its inputs and against each other.
pub struct Outputs {
    force: bool,
    /// Words after "expected" in the error if an output exists, such as "another folder".
    remedy: &'static str,
    /// Files that must not be written to: their role and path.
    taken: Vec<(&'static str, PathBuf)>,
}

impl Outputs {
    /// Creates the outputs of a command that reads `inputs`. Inputs that are not files, such as the name of a built-in
    /// experiment, are ignored. Existing outputs are replaced if `force` is `true`.
    pub fn new<'a>(force: bool, inputs: impl IntoIterator<Item = Option<&'a Path>>) -> Self {
        let inputs = inputs.into_iter().flatten();
        let taken = inputs.map(|path| ("an input", path.to_path_buf()));
        Self {
            force,
            remedy: "a new file, or --force to replace it",
            taken: taken.collect(),
        }
    }

    /// Creates the outputs of a command that cannot replace files and reads none. If an output exists, the error names the
    /// `remedy`, such as "another folder".
    pub fn without_force(remedy: &'static str) -> Self {
        Self {
            remedy,
            ..Self::new(false, [])
        }
    }

    /// Creates the part file of the output at `path`, which is specified by the command-line option `argument`.
    ///
    /// # Errors
    /// If `path` is an input or another output, exists without `force`, is not a regular file, or cannot be written.
    pub fn create(&mut self, path: &Path, argument: &'static str) -> Result<PartFile, OutputError> {
        let refused = |path: &Path, problem: &str| OutputError::Refused {
            argument,
            path: path.to_owned(),
            problem: problem.into(),
        };
        let part = part_of(path);
        for (what, taken) in &self.taken {
            if is_same_file(path, taken) || is_same_file(&part, taken) {
                return Err(refused(
                    path,
                    &format!("the file is {what}; expected another file"),
                ));
            }
        }
        for written in [path, &part] {
            // Writing to a device or a link, or renaming a file to it, would change its target.
            if fs::symlink_metadata(written).is_ok_and(|there| !there.is_file()) {
                return Err(refused(path, "not a file; expected another path"));
            }
        }
        let partial = fs::metadata(&part).is_ok_and(|there| there.len() > 0);
        for (exists, written) in [(path.exists(), path), (partial, &part)] {
            if exists && !self.force {
                let problem = format!("exists already; expected {}", self.remedy);
                return Err(refused(written, &problem));
            }
        }
        let file = File::create(&part).map_err(|e| failed(path, argument, e))?;
        self.taken
            .push(("the output of another option", path.to_path_buf()));
        Ok(PartFile {
            file,
            part,
            path: path.to_owned(),
            argument,
            is_done: false,
        })
    }
}

/// File that is written as `NAME.part` and renamed when complete. A partial file keeps the name `NAME.part`.
pub struct PartFile {
    file: File,
    part: PathBuf,
    path: PathBuf,
    argument: &'static str,
    is_done: bool,
}

impl PartFile {
    /// Path of the incomplete file.
    pub fn part(&self) -> &Path {
        &self.part
    }

    /// Returns a handle to write to the file piece by piece.
    ///
    /// # Errors
    /// If the system has no file handle left.
    pub fn writer(&self) -> io::Result<File> {
        self.file.try_clone()
    }

    /// Writes `bytes` and renames the file to its final name.
    ///
    /// # Errors
    /// If the file cannot be written; the message names the remaining part file.
    pub fn finish(mut self, bytes: &[u8]) -> Result<(), OutputError> {
        if let Err(error) = self.file.write_all(bytes) {
            return Err(OutputError::Partial {
                cause: Box::new(failed(&self.path, self.argument, error)),
                part: self.part.clone(),
            });
        }
        self.rename()
    }

    /// Renames the complete file to its final name.
    ///
    /// # Errors
    /// If it cannot be renamed.
    pub fn rename(mut self) -> Result<(), OutputError> {
        fs::rename(&self.part, &self.path).map_err(|e| failed(&self.path, self.argument, e))?;
        self.is_done = true;
        Ok(())
    }

    /// Removes the part file.
    pub fn discard(self) {
        // If it cannot be removed, its name still marks it as partial.
        let _ = fs::remove_file(&self.part);
    }

    /// Removes an incomplete last line of a table, such as one cut off by a full disk.
    pub fn drop_torn_line(&self) {
        // A file that cannot be read back stays unchanged; its name marks it as partial.
        let _ = cut_torn_line(&self.part);
    }
}

impl Drop for PartFile {
    fn drop(&mut self) {
        let is_empty = || fs::metadata(&self.part).is_ok_and(|there| there.len() == 0);
        if !self.is_done && is_empty() {
            let _ = fs::remove_file(&self.part);
        }
    }
}

fn part_of(path: &Path) -> PathBuf {
    let mut part = path.as_os_str().to_owned();
    part.push(".part");
    part.into()
}

/// Removes the last line of the table at `path` if it has no line feed.
///
/// # Errors
/// If the file cannot be read or truncated.
pub fn cut_torn_line(path: &Path) -> io::Result<()> {
    let mut file = File::options().read(true).write(true).open(path)?;
    let length = file.metadata()?.len();
    let start = length.saturating_sub(MAX_ROW);
    file.seek(SeekFrom::Start(start))?;
    let mut tail = Vec::new();
    file.read_to_end(&mut tail)?;
    if let Some(end) = tail.iter().rposition(|&byte| byte == b'\n') {
        file.set_len(start + end as u64 + 1)?;
    }
    Ok(())
}

/// Returns `true` if both paths refer to the same file, including by a link or another spelling.
fn is_same_file(a: &Path, b: &Path) -> bool {
    if let (Some(a), Some(b)) = (resolved(a), resolved(b))
        && a == b
    {
        return true;
    }
    match (fs::metadata(a), fs::metadata(b)) {
        (Ok(a), Ok(b)) => a.is_file() && is_same_inode(&a, &b),
        _ => false,
    }
}

/// Canonical path. For a file that does not exist yet: the canonical path of its folder, joined with its name.
fn resolved(path: &Path) -> Option<PathBuf> {
    if let Ok(path) = path.canonicalize() {
        return Some(path);
    }
    let folder = match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    Some(folder.canonicalize().ok()?.join(path.file_name()?))
}

#[cfg(unix)]
fn is_same_inode(a: &fs::Metadata, b: &fs::Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    (a.dev(), a.ino()) == (b.dev(), b.ino())
}

#[cfg(not(unix))]
fn is_same_inode(_: &fs::Metadata, _: &fs::Metadata) -> bool {
    false
}

fn failed(path: &Path, argument: &'static str, error: io::Error) -> OutputError {
    OutputError::Io {
        argument,
        path: path.to_owned(),
        error,
    }
}
