//! Video files of a data set.

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

/// Writers of a data set's video files: one open file per camera feature, filled episode by episode.
pub(crate) struct Videos {
    folder: PathBuf,
    files: BTreeMap<String, VideoFile>,
}

/// The open video file of a camera feature.
struct VideoFile {
    number: usize,
    path: PathBuf,
    video: Mp4,
}

/// An encoded episode of one camera feature.
pub(crate) struct Written {
    /// Feature key.
    pub key: String,
    /// Segment that contains the episode.
    pub place: VideoPlace,
    /// Statistics of the images.
    pub stats: Stats,
}

impl Videos {
    /// Creates the video writers of the data set in `folder`.
    pub fn new(folder: &Path) -> Self {
        Self {
            folder: folder.to_path_buf(),
            files: BTreeMap::new(),
        }
    }

    /// Encodes an episode's images, one thread per camera.
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
            let from = file.video.time();
            let stats = camera.encode(&mut file.video, watch)?;
            let place = VideoPlace {
                file: file.number,
                from,
                to: file.video.time(),
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

    /// Finishes all open files.
    pub fn finish(self) -> Result<(), ExportError> {
        self.files.into_values().try_for_each(VideoFile::finish)
    }

    /// Open file for a camera's images. Starts a new file if there is no file yet or the current one is full.
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
            video: video.map_err(ExportError::of_file(&path))?,
            path,
        })
    }
}

impl VideoFile {
    fn finish(self) -> Result<(), ExportError> {
        let finished = self.video.finish();
        finished.map_err(ExportError::of_file(&self.path))
    }
}

/// Creates a file and its parent folders.
pub(crate) fn create(path: &Path) -> Result<File, ExportError> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(ExportError::of_file(folder))?;
    }
    File::create(path).map_err(ExportError::of_file(path))
}
