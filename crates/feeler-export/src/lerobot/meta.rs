//! Metadata of a data set: `info.json`, `stats.json`, tasks and episodes.

use super::stats::Stats;
use crate::columnar::{AnyCells, Cells, Column};
use parquet::data_type::ByteArray;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// LeRobot format version.
const FORMAT: &str = "v3.0";
/// Robot type in `info.json`.
const ROBOT: &str = "feeler";
/// Maximum number of files per folder (LeRobot's default).
const FILES_OF_A_CHUNK: usize = 1000;
/// Bytes per megabyte, as defined by LeRobot.
const MEGABYTE: usize = 1 << 20;

/// File sizes (MiB) at which the next episode starts a new file. Episodes are never split.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FileSizes {
    /// Size limit of a data file (MiB).
    pub data: usize,
    /// Size limit of a video file (MiB).
    pub videos: usize,
}

impl Default for FileSizes {
    /// LeRobot's defaults.
    fn default() -> Self {
        Self {
            data: 100,
            videos: 200,
        }
    }
}

impl FileSizes {
    /// `true` if a data file of this size accepts no further episode.
    pub(crate) fn is_full_of_data(self, bytes: usize) -> bool {
        bytes >= self.data * MEGABYTE
    }

    /// `true` if a video file of this size accepts no further episode.
    pub(crate) fn is_full_of_video(self, bytes: u64) -> bool {
        bytes >= (self.videos * MEGABYTE) as u64
    }
}

/// Relative path of the file with this number in `folder`.
pub(crate) fn file_path(folder: &str, number: usize, extension: &str) -> String {
    let (chunk, file) = chunk_and_file(number);
    format!("{folder}/chunk-{chunk:03}/file-{file:03}.{extension}")
}

/// Chunk index and file index of the file with this number.
pub(crate) fn chunk_and_file(number: usize) -> (usize, usize) {
    (number / FILES_OF_A_CHUNK, number % FILES_OF_A_CHUNK)
}

/// An episode's entry in the list of episodes.
pub(crate) struct Episode {
    /// Name of the run.
    pub run: String,
    /// Digest of the run's recording.
    pub digest: String,
    /// Task description in natural language.
    pub task: String,
    /// Number of frames.
    pub length: usize,
    /// Time of the first frame within the run (s), if it is part of the metadata.
    pub start: Option<f64>,
    /// Index of the first frame within the data set.
    pub from: usize,
    /// Number of the data file with the episode's rows.
    pub data_file: usize,
    /// Video segment of each camera feature.
    pub videos: BTreeMap<String, VideoPlace>,
    /// Statistics of each feature.
    pub stats: BTreeMap<String, Stats>,
}

/// Segment of a video file that contains an episode.
#[derive(Debug, Clone, Copy)]
pub(crate) struct VideoPlace {
    /// Number of the video file.
    pub file: usize,
    /// Time of the first frame within the file (s).
    pub from: f64,
    /// End time within the file (s).
    pub to: f64,
}

/// Contents of `info.json`.
pub(crate) fn info(
    rate: u32,
    features: &Map<String, Value>,
    episodes: &[Episode],
    tasks: usize,
    sizes: FileSizes,
) -> Value {
    let has_videos = episodes.iter().any(|episode| !episode.videos.is_empty());
    let chunk = "chunk-{chunk_index:03d}/file-{file_index:03d}";
    json!({
        "codebase_version": FORMAT,
        "robot_type": ROBOT,
        "fps": rate,
        "features": features,
        "total_episodes": episodes.len(),
        "total_frames": episodes.iter().map(|episode| episode.length).sum::<usize>(),
        "total_tasks": tasks,
        "chunks_size": FILES_OF_A_CHUNK,
        "data_files_size_in_mb": sizes.data,
        "video_files_size_in_mb": sizes.videos,
        "splits": { "train": format!("0:{}", episodes.len()) },
        "data_path": format!("data/{chunk}.parquet"),
        "video_path": has_videos.then(|| format!("videos/{{video_key}}/{chunk}.mp4")),
    })
}

/// Contents of `stats.json`: statistics over all episodes.
pub(crate) fn stats(episodes: &[Episode]) -> Value {
    let mut all: BTreeMap<&String, Stats> = BTreeMap::new();
    for (key, stats) in episodes.iter().flat_map(|episode| &episode.stats) {
        match all.get_mut(key) {
            Some(before) => before.add(stats),
            None => _ = all.insert(key, stats.clone()),
        }
    }
    let stats = all
        .into_iter()
        .map(|(key, stats)| (key.clone(), stats.json()));
    Value::Object(stats.collect())
}

/// Contents of `tasks.parquet`: a pandas data frame indexed by task.
pub(crate) fn tasks(tasks: &[String]) -> (Vec<Column>, Vec<(String, String)>) {
    let columns = vec![
        column("task_index", AnyCells::counts(0..tasks.len())),
        column("task", AnyCells::texts(tasks)),
    ];
    let described = |name: &str, pandas: &str, numpy: &str| {
        json!({
            "name": name, "field_name": name, "pandas_type": pandas, "numpy_type": numpy, "metadata": null,
        })
    };
    let pandas = json!({
        "index_columns": ["task"],
        "column_indexes": [],
        "columns": [described("task_index", "int64", "int64"), described("task", "unicode", "object")],
        "pandas_version": "2.0.0",
    });
    (columns, vec![("pandas".into(), pandas.to_string())])
}

/// Columns of the table of episodes, with one row per episode.
pub(crate) fn episodes(episodes: &[Episode]) -> Vec<Column> {
    let counts = |number: &dyn Fn(usize, &Episode) -> usize| {
        let numbers = episodes.iter().enumerate().map(|(i, e)| number(i, e));
        AnyCells::counts(numbers)
    };
    let task = |episode: &Episode| Some([ByteArray::from(episode.task.as_str())]);
    let tasks = Cells::of_lists(episodes.iter().map(task));
    let mut columns = vec![
        column("episode_index", counts(&|i, _| i)),
        column("tasks", AnyCells::Text(tasks)),
        column("length", counts(&|_, e| e.length)),
        column(
            "data/chunk_index",
            counts(&|_, e| chunk_and_file(e.data_file).0),
        ),
        column(
            "data/file_index",
            counts(&|_, e| chunk_and_file(e.data_file).1),
        ),
        column("dataset_from_index", counts(&|_, e| e.from)),
        column("dataset_to_index", counts(&|_, e| e.from + e.length)),
        column("meta/episodes/chunk_index", counts(&|_, _| 0)),
        column("meta/episodes/file_index", counts(&|_, _| 0)),
        column(
            "feeler/run",
            AnyCells::texts(episodes.iter().map(|e| &e.run)),
        ),
        column(
            "feeler/digest",
            AnyCells::texts(episodes.iter().map(|e| &e.digest)),
        ),
    ];
    let first = episodes.first();
    if first.is_some_and(|episode| episode.start.is_some()) {
        let starts = Cells::of_values(episodes.iter().map(|e| e.start));
        columns.push(column("feeler/start_s", AnyCells::Double(starts)));
    }
    for key in first.into_iter().flat_map(|episode| episode.videos.keys()) {
        columns.extend(video_columns(key, episodes));
    }
    for (key, stats) in first.into_iter().flat_map(|episode| &episode.stats) {
        columns.extend(stats_columns(key, stats, episodes));
    }
    columns
}

fn video_columns(key: &str, episodes: &[Episode]) -> [Column; 4] {
    let places = || {
        episodes
            .iter()
            .filter_map(|episode| episode.videos.get(key))
    };
    let count = |number: fn(&VideoPlace) -> usize| AnyCells::counts(places().map(number));
    let time = |time: fn(&VideoPlace) -> f64| {
        AnyCells::Double(Cells::of_values(places().map(|place| Some(time(place)))))
    };
    let name = |what: &str| format!("videos/{key}/{what}");
    [
        column(
            name("chunk_index"),
            count(|place| chunk_and_file(place.file).0),
        ),
        column(
            name("file_index"),
            count(|place| chunk_and_file(place.file).1),
        ),
        column(name("from_timestamp"), time(|place| place.from)),
        column(name("to_timestamp"), time(|place| place.to)),
    ]
}

/// Columns with a feature's statistics per episode. The first episode determines their shape.
fn stats_columns(key: &str, of_first: &Stats, episodes: &[Episode]) -> Vec<Column> {
    let all = || episodes.iter().filter_map(|episode| episode.stats.get(key));
    let numbers = of_first.numbers().enumerate().map(|(place, (name, _))| {
        let numbers = all().flat_map(|stats| stats.numbers().nth(place));
        let numbers = numbers.flat_map(|(_, numbers)| numbers.iter().copied());
        let cells = Cells::of_arrays(&of_first.shape, numbers);
        column(format!("stats/{key}/{name}"), AnyCells::Double(cells))
    });
    let mut columns: Vec<_> = numbers.collect();
    let counts = Cells::of_arrays(&[1], all().map(|stats| stats.count() as i64));
    columns.push(column(format!("stats/{key}/count"), AnyCells::Int(counts)));
    columns
}

fn column(name: impl Into<String>, cells: AnyCells) -> Column {
    Column {
        name: name.into(),
        cells,
    }
}
