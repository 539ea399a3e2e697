//! Writer of a LeRobot data set.

use super::episode::features;
use super::feature::{Feature, Values};
use super::frames::{Frames, Sampling};
use super::meta::{self, Episode, FileSizes, file_path};
use super::run::Run;
use super::video::{Watch, cameras};
use super::videos::{Videos, create};
use crate::columnar::{Column, ParquetFile};
use crate::error::ExportError;
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Writer of a LeRobot data set (format v3.0): add runs, then finish. LeRobot does not recognize the folder until
/// `finish` has written `meta/`.
///
/// Each control step is a frame, starting with the first step at which all fingers have readings. Features are 32-bit
/// numbers:
///
/// | feature | shape | content |
/// |---|---|---|
/// | `observation.state` | \[3 F\] | joint angles of all fingers, rad |
/// | `action` | \[3 F\] | joint velocities as sent to the drives at that step, rad/s |
/// | `observation.tactile.finger_N.force` | \[E, 3\] | force on each element in its frame, N: x, y tangential, on the element by the object; z compression, positive when pressed |
/// | `observation.tactile.finger_N.flags` | \[3\] | TOUCH, SLIP, OVER |
/// | `observation.tactile.finger_N.grasp_force` | \[1\] | sum of the positive compressions, N |
/// | `observation.tactile.finger_N.window.force` | \[W, E, 3\] | the latest W tactile samples at the frame, oldest first, N; with [`Sampling::window`] |
/// | `observation.tactile.finger_N.window.time` | \[W\] | time of each sample relative to the frame's timestamp, s |
/// | `observation.tactile.finger_N.window.is_new` | \[W\] | `true` for samples since the previous frame |
/// | `operator.felt` | \[4\] | feedback of the live page, if the run had one: strong and weak rumble (0 to 1), tone frequency (Hz) and gain (0 to 1) |
/// | `observation.images.finger_N` | \[height, width, 3\] | the camera's image if images were recorded: gray, as a video (AV1 in MP4) |
pub struct DataSet {
    folder: PathBuf,
    /// Frame rate and feature descriptions of the first run.
    kind: Option<(u32, Map<String, Value>)>,
    sampling: Sampling,
    sizes: FileSizes,
    data: Option<DataFile>,
    videos: Videos,
    tasks: Vec<String>,
    episodes: Vec<Episode>,
}

/// The data file that rows are written to.
struct DataFile {
    number: usize,
    file: ParquetFile<File>,
}

impl DataSet {
    /// Creates a data set in `folder`, which must exist and be empty.
    pub fn new(folder: &Path) -> Self {
        Self {
            folder: folder.to_path_buf(),
            kind: None,
            sampling: Sampling::default(),
            sizes: FileSizes::default(),
            data: None,
            videos: Videos::new(folder),
            tasks: Vec::new(),
            episodes: Vec::new(),
        }
    }

    /// Replaces LeRobot's default file sizes.
    #[must_use]
    pub fn with_file_sizes(self, sizes: FileSizes) -> Self {
        Self { sizes, ..self }
    }

    /// Replaces the default of a frame per control step without windows of tactile samples.
    #[must_use]
    pub fn with_sampling(self, sampling: Sampling) -> Self {
        Self { sampling, ..self }
    }

    /// Adds a run as the next episode and returns its number of frames.
    ///
    /// # Errors
    /// If the recording is incomplete or contains an unknown (NaN) value, if its rate, fingers or elements differ from
    /// earlier runs, if the windows are too short, if an image cannot be read or a file cannot be written, or if the export is interrupted.
    pub fn add(&mut self, run: &Run<'_>, watch: Watch<'_>) -> Result<usize, ExportError> {
        let Sampling { fps, window } = self.sampling;
        let frames = Frames::of(run.name, run.recording, self.sampling)?;
        let (rate, length) = (frames.rate, frames.steps.len());
        let mut features = features(run.name, run.recording, &frames, window)?;
        let from = self
            .episodes
            .last()
            .map_or(0, |last| last.from + last.length);
        let task = self.task_index(run.task);
        features.extend(default_features(
            rate,
            length,
            self.episodes.len(),
            from,
            task,
        ));
        let cameras = cameras(run, rate, &frames.steps)?;
        let described = features.iter().map(|f| (f.key.clone(), f.description()));
        let seen = cameras.iter().map(|c| (c.key.clone(), c.description()));
        self.check_kind(run.name, rate, described.chain(seen).collect())?;
        let mut stats = BTreeMap::new();
        for feature in &features {
            stats.insert(feature.key.clone(), feature.stats());
        }
        let mut videos = BTreeMap::new();
        for video in self.videos.add(cameras, self.sizes, watch)? {
            stats.insert(video.key.clone(), video.stats);
            videos.insert(video.key, video.place);
        }
        let columns: Vec<_> = features.iter().map(Feature::column).collect();
        let data_file = self.write_rows(&columns)?;
        self.episodes.push(Episode {
            run: run.name.into(),
            digest: run.recording.digest.to_string(),
            task: run.task.into(),
            length,
            start: (fps.is_some() || window.is_some()).then_some(frames.start),
            from,
            data_file,
            videos,
            stats,
        });
        Ok(length)
    }

    /// Completes the data set by writing its metadata.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn finish(self) -> Result<(), ExportError> {
        if let Some(data) = self.data {
            data.file.close()?;
        }
        self.videos.finish()?;
        let (rate, features) = self.kind.unwrap_or_default();
        let info = meta::info(
            rate,
            &features,
            &self.episodes,
            self.tasks.len(),
            self.sizes,
        );
        write_json(
            &self.folder.join("meta/stats.json"),
            &meta::stats(&self.episodes),
        )?;
        let (tasks, about) = meta::tasks(&self.tasks);
        write_table(&self.folder.join("meta/tasks.parquet"), &tasks, about)?;
        let episodes = self.folder.join(file_path("meta/episodes", 0, "parquet"));
        write_table(&episodes, &meta::episodes(&self.episodes), Vec::new())?;
        write_json(&self.folder.join("meta/info.json"), &info)
    }

    /// Index of a task; new tasks get the next free index.
    fn task_index(&mut self, task: &str) -> usize {
        let known = self.tasks.iter().position(|known| known == task);
        known.unwrap_or_else(|| {
            self.tasks.push(task.into());
            self.tasks.len() - 1
        })
    }

    /// Checks that a run has the same rate and features as the first one.
    fn check_kind(
        &mut self,
        run: &str,
        rate: u32,
        features: Map<String, Value>,
    ) -> Result<(), ExportError> {
        let (first_rate, first) = self.kind.get_or_insert_with(|| (rate, features.clone()));
        let refuse = |what: &str, expected: String, actual: String| {
            let expected = format!("{expected} as in the first run");
            Err(ExportError::of_run(run, what, expected, actual))
        };
        if rate != *first_rate {
            let steps = |rate| format!("{rate} control steps per second");
            return refuse("rate", steps(*first_rate), steps(rate));
        }
        let keys = |features: &Map<String, Value>| {
            let keys: Vec<_> = features.keys().map(String::as_str).collect();
            keys.join(", ")
        };
        if !features.keys().eq(first.keys()) {
            return refuse("features", keys(first), keys(&features));
        }
        for (key, feature) in &features {
            let (feature, first) = (feature, &first[key]);
            let part = ["shape", "dtype"]
                .into_iter()
                .find(|part| feature[part] != first[part]);
            if let Some(part) = part {
                let words = |feature: &Value| format!("{part} {}", feature[part]);
                return refuse(key, words(first), words(feature));
            }
            if feature != first {
                return refuse(key, "the same fingertip".into(), "a different one".into());
            }
        }
        Ok(())
    }

    /// Writes the rows of an episode and returns the number of the file that contains them.
    fn write_rows(&mut self, columns: &[Column]) -> Result<usize, ExportError> {
        let sizes = self.sizes;
        let is_full = |data: &mut DataFile| sizes.is_full_of_data(data.file.size());
        let mut number = 0;
        if let Some(full) = self.data.take_if(is_full) {
            number = full.number + 1;
            full.file.close()?;
        }
        let data = match &mut self.data {
            Some(data) => data,
            none => {
                let path = self.folder.join(file_path("data", number, "parquet"));
                let file = ParquetFile::create(create(&path)?, columns, Vec::new())?;
                none.insert(DataFile { number, file })
            }
        };
        data.file.write(columns)?;
        Ok(data.number)
    }
}

/// Index and time features that LeRobot requires in every data set.
fn default_features(
    rate: u32,
    length: usize,
    episode: usize,
    from: usize,
    task: usize,
) -> [Feature; 5] {
    let time = |frame: usize| (frame as f64 / f64::from(rate)) as f32;
    let times = Values::Float((0..length).map(time).collect());
    let all = |number| std::iter::repeat_n(number, length);
    [
        Feature::of_one("timestamp", times),
        Feature::index("frame_index", 0..length),
        Feature::index("episode_index", all(episode)),
        Feature::index("index", from..from + length),
        Feature::index("task_index", all(task)),
    ]
}

fn write_json(path: &Path, value: &Value) -> Result<(), ExportError> {
    let mut file = create(path)?;
    let written = file.write_all(format!("{value:#}").as_bytes());
    written.map_err(ExportError::of_file(path))
}

fn write_table(
    path: &Path,
    columns: &[Column],
    about: Vec<(String, String)>,
) -> Result<(), ExportError> {
    let mut file = ParquetFile::create(create(path)?, columns, about)?;
    file.write(columns)?;
    Ok(file.close()?)
}
