//! The files of a data set's videos.

use super::meta::{FileSizes, VideoPlace, file_path};
use super::mp4::Mp4;
use super::stats::Stats;
use super::video::{Camera, Watch};
use crate::error::ExportError;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::thread;

/// The videos of a data set while it is written: of each feature one that takes episode after episode until it is full.
pub(crate) struct Videos {
    folder: PathBuf,
    files: BTreeMap<String, VideoFile>,
}

/// The file that the pictures of a feature are written to.
struct VideoFile {
    number: usize,
    path: PathBuf,
    rate: u32,
    video: Mp4,
}

/// The pictures of a feature over an episode, now that they are written.
pub(crate) struct Written {
    /// The feature.
    pub key: String,
    /// Where they are.
    pub place: VideoPlace,
    /// Their statistics.
    pub stats: Stats,
}

impl Videos {
    /// Those of the data set in `folder`.
    pub fn new(folder: &Path) -> Self {
        Self {
            folder: folder.to_path_buf(),
            files: BTreeMap::new(),
        }
    }

    /// Encodes the pictures of an episode, those of each camera on a thread of its own.
    pub fn add(
        &mut self,
        cameras: Vec<Camera<'_>>,
        sizes: FileSizes,
        watch: Watch<'_>,
    ) -> Result<Vec<Written>, ExportError> {
        let mut work = Vec::new();
        for camera in cameras {
            let file = self.take_file(&camera, sizes)?;
            work.push((camera, file));
        }
        let encode = |(camera, mut file): (Camera<'_>, VideoFile)| {
            let key = camera.key.clone();
            let from = file.time();
            let stats = camera.encode(&mut file.video, watch)?;
            let place = VideoPlace {
                file: file.number,
                from,
                to: file.time(),
            };
            Ok((file, Written { key, place, stats }))
        };
        let done: Vec<Result<_, ExportError>> = thread::scope(|scope| {
            let start = |work| scope.spawn(move || encode(work));
            let threads: Vec<_> = work.into_iter().map(start).collect();
            let end = |thread: thread::ScopedJoinHandle<'_, _>| {
                thread.join().unwrap_or_else(|panic| resume_unwind(panic))
            };
            threads.into_iter().map(end).collect()
        });
        let mut written = Vec::new();
        for done in done {
            let (file, of_camera) = done?;
            self.files.insert(of_camera.key.clone(), file);
            written.push(of_camera);
        }
        Ok(written)
    }

    /// Ends all of them.
    pub fn finish(self) -> Result<(), ExportError> {
        self.files.into_values().try_for_each(VideoFile::finish)
    }

    /// The file for the pictures of a camera: the one of before, or a new one where there is none or it is full.
    fn take_file(
        &mut self,
        camera: &Camera<'_>,
        sizes: FileSizes,
    ) -> Result<VideoFile, ExportError> {
        let before = self.files.remove(&camera.key);
        let number = match before {
            Some(file) if !sizes.is_full_of_video(file.video.size()) => return Ok(file),
            Some(full) => {
                let next = full.number + 1;
                full.finish()?;
                next
            }
            None => 0,
        };
        let name = file_path(&format!("videos/{}", camera.key), number, "mp4");
        let path = self.folder.join(name);
        let video = Mp4::create(create(&path)?, camera.rate, camera.size);
        Ok(VideoFile {
            number,
            rate: camera.rate,
            video: video.map_err(ExportError::of_file(&path))?,
            path,
        })
    }
}

impl VideoFile {
    /// Time at which the next picture is shown, s.
    fn time(&self) -> f64 {
        self.video.pictures() as f64 / f64::from(self.rate)
    }

    fn finish(self) -> Result<(), ExportError> {
        let finished = self.video.finish();
        finished.map_err(ExportError::of_file(&self.path))
    }
}

/// Makes a file, and the folders that it is in.
pub(crate) fn create(path: &Path) -> Result<File, ExportError> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(ExportError::of_file(folder))?;
    }
    File::create(path).map_err(ExportError::of_file(path))
}
