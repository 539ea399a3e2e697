//! Output files: never overwrite an input, overwrite an existing file only with `--force`, and get their final name
//! only when complete.

use super::CommandError;
use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Maximum length of a table's row (bytes); limits the search for its start.
const MAX_ROW: u64 = 1 << 20;

/// The `--force` option.
#[derive(Debug, Clone, Copy, clap::Args)]
pub struct Overwrite {
    /// Overwrite existing output files. Input files are never overwritten.
    #[arg(long)]
    pub force: bool,
}

/// The output files of a command, checked against its inputs and each other.
pub struct Outputs {
    overwrite: Overwrite,
    /// Paths that must not be written to, each with a description.
    taken: Vec<(&'static str, PathBuf)>,
}

impl Outputs {
    /// Creates the outputs of a command that reads `inputs`. Inputs that are not files, such as names of built-in
    /// experiments, are harmless.
    pub fn new<'a>(
        overwrite: Overwrite,
        inputs: impl IntoIterator<Item = Option<&'a Path>>,
    ) -> Self {
        let inputs = inputs.into_iter().flatten();
        let taken = inputs.map(|path| ("an input", path.to_path_buf()));
        Self {
            overwrite,
            taken: taken.collect(),
        }
    }

    /// Creates the partial file for `path`, which was given by the option `argument`.
    ///
    /// # Errors
    /// If `path` is an input or another output, exists without `--force`, is not a file, or cannot be written.
    pub fn create(
        &mut self,
        path: &Path,
        argument: &'static str,
    ) -> Result<PartFile, CommandError> {
        let refuse = |what: &str| format!("{argument} {}: {what}", path.display());
        let part = part_of(path);
        for (what, taken) in &self.taken {
            if is_same_file(path, taken) || is_same_file(&part, taken) {
                return Err(refuse(&format!("the file is {what}; expected another file")).into());
            }
        }
        for written in [path, &part] {
            // Writing to a device or link, or renaming a file over it, would modify its target.
            if fs::symlink_metadata(written).is_ok_and(|there| !there.is_file()) {
                return Err(refuse("not a file; expected a new file, or a file to replace").into());
            }
        }
        let partial = fs::metadata(&part).is_ok_and(|there| there.len() > 0);
        for (exists, written) in [(path.exists(), path), (partial, &part)] {
            if exists && !self.overwrite.force {
                let written = written.display();
                let what = "exists already; expected a new file, or --force to replace it";
                return Err(format!("{argument} {written}: {what}").into());
            }
        }
        let file = File::create(&part).map_err(|e| failed(path, argument, &e))?;
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

/// A file that is written as `NAME.part` and renamed when complete. A partial file is kept after a failure.
pub struct PartFile {
    file: File,
    part: PathBuf,
    path: PathBuf,
    argument: &'static str,
    is_done: bool,
}

impl PartFile {
    /// Returns the path of the partial file.
    pub fn part(&self) -> &Path {
        &self.part
    }

    /// Returns a handle for incremental writes.
    ///
    /// # Errors
    /// If the system has no file handle left.
    pub fn writer(&self) -> io::Result<File> {
        self.file.try_clone()
    }

    /// Writes the whole contents and renames the file.
    ///
    /// # Errors
    /// If writing fails. The message names the partial file that remains.
    pub fn finish(mut self, bytes: &[u8]) -> Result<(), CommandError> {
        if let Err(error) = self.file.write_all(bytes) {
            let message = failed(&self.path, self.argument, &error);
            let part = self.part.display();
            return Err(format!("{message}; {part} is partial").into());
        }
        self.rename()
    }

    /// Renames the complete file to its final path.
    ///
    /// # Errors
    /// If the file cannot be renamed.
    pub fn rename(mut self) -> Result<(), CommandError> {
        fs::rename(&self.part, &self.path).map_err(|e| failed(&self.path, self.argument, &e))?;
        self.is_done = true;
        Ok(())
    }

    /// Removes the partial file.
    pub fn discard(self) {
        // If removal fails, the name still marks the file as partial.
        let _ = fs::remove_file(&self.part);
    }

    /// Removes an unterminated last line of a table, e.g. after the disk was full.
    pub fn drop_torn_line(&self) {
        // On failure the file stays as it is; its name marks it as partial.
        let _ = cut_torn_line(&self.part);
    }
}

impl Drop for PartFile {
    fn drop(&mut self) {
        let is_empty = || fs::metadata(&self.part).is_ok_and(|there| there.len() == 0);
        if !self.is_done && is_empty() {
            // An empty partial file is useless.
            let _ = fs::remove_file(&self.part);
        }
    }
}

fn part_of(path: &Path) -> PathBuf {
    let mut part = path.as_os_str().to_owned();
    part.push(".part");
    part.into()
}

/// Removes an unterminated last line of the table at `path`.
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

/// Returns `true` if two paths refer to the same file, including through links.
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

/// Resolves links in a path; if the file does not exist yet, those in its folder's path.
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

fn failed(path: &Path, argument: &str, error: &io::Error) -> String {
    let path = path.display();
    format!("{argument} {path}: {error}; expected a file in a writable folder")
}
