//! Output files: never over an input, never over an existing file without `--force`, and under their own name only when
//! whole.

use super::CommandError;
use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Longest row of a table, bytes: as far as its beginning is looked for.
const MAX_ROW: u64 = 1 << 20;

/// Whether existing files may be replaced.
#[derive(Debug, Clone, Copy, clap::Args)]
pub struct Overwrite {
    /// Replace output files that exist already. Input files are never replaced.
    #[arg(long)]
    pub force: bool,
}

/// The output files of one command, held against its inputs and against each other.
pub struct Outputs {
    overwrite: Overwrite,
    /// Files that must not be written to: a word for what they are, and where.
    taken: Vec<(&'static str, PathBuf)>,
}

impl Outputs {
    /// The outputs of a command that reads `inputs`. Those that are no files, as the name of a built-in experiment, do not
    /// matter.
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

    /// Begins the file that the command line's `argument` says is to be at `path`.
    ///
    /// # Errors
    /// When it is an input or another output, exists without `--force`, is no file, or cannot be written.
    pub fn create(
        &mut self,
        path: &Path,
        argument: &'static str,
    ) -> Result<PartFile, CommandError> {
        let refuse = |what: &str| format!("{argument} {}: {what}", path.display());
        let part = part_of(path);
        for (what, taken) in &self.taken {
            if is_same_file(path, taken) || is_same_file(&part, taken) {
                return Err(refuse(&format!("it is {what}; expected another file")).into());
            }
        }
        for written in [path, &part] {
            // Writing to a device or a link, or moving a file over it, would change what is behind it.
            if fs::symlink_metadata(written).is_ok_and(|there| !there.is_file()) {
                return Err(refuse("not a file; expected a file, new or to replace").into());
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
            .push(("written for another option", path.to_path_buf()));
        Ok(PartFile {
            file,
            part,
            path: path.to_owned(),
            argument,
            is_done: false,
        })
    }
}

/// A file that is written as `NAME.part` and renamed when it is whole. What was written of it otherwise is kept under that
/// name.
pub struct PartFile {
    file: File,
    part: PathBuf,
    path: PathBuf,
    argument: &'static str,
    is_done: bool,
}

impl PartFile {
    /// Where it is until it is whole.
    pub fn part(&self) -> &Path {
        &self.part
    }

    /// To write to it piece by piece.
    ///
    /// # Errors
    /// When the system has no handle left.
    pub fn writer(&self) -> io::Result<File> {
        self.file.try_clone()
    }

    /// Writes all of it and moves it to its place.
    ///
    /// # Errors
    /// When it cannot be written: the message names the part file that is left.
    pub fn finish(mut self, bytes: &[u8]) -> Result<(), CommandError> {
        if let Err(error) = self.file.write_all(bytes) {
            let message = failed(&self.path, self.argument, &error);
            let part = self.part.display();
            return Err(format!("{message}; {part} is partial").into());
        }
        self.rename()
    }

    /// Moves it to its place, now that it is whole.
    ///
    /// # Errors
    /// When it cannot be moved.
    pub fn rename(mut self) -> Result<(), CommandError> {
        fs::rename(&self.part, &self.path).map_err(|e| failed(&self.path, self.argument, &e))?;
        self.is_done = true;
        Ok(())
    }

    /// Removes what was written of it.
    pub fn discard(self) {
        // Should it not go, its name still says that it is partial.
        let _ = fs::remove_file(&self.part);
    }

    /// Cuts off the last line of a table if it has no end, as where the disk was full.
    pub fn drop_torn_line(&self) {
        // What cannot be read back stays as it is, and is called partial all the same.
        let _ = cut_torn_line(&self.part);
    }
}

impl Drop for PartFile {
    fn drop(&mut self) {
        let is_empty = || fs::metadata(&self.part).is_ok_and(|there| there.len() == 0);
        if !self.is_done && is_empty() {
            // Of no use to anyone.
            let _ = fs::remove_file(&self.part);
        }
    }
}

fn part_of(path: &Path) -> PathBuf {
    let mut part = path.as_os_str().to_owned();
    part.push(".part");
    part.into()
}

/// Cuts off the last line of the table at `path` if it has no end.
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

/// Whether two paths lead to one file, by another spelling or a link, too.
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

/// The path without links and detours; of a file that does not exist yet, that of its folder with the file's name.
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
    format!("{argument} {path}: {error}; expected a file in a folder that can be written to")
}
