//! What a data set says of itself: `info.json`, `stats.json`, tasks and episodes.

use super::stats::Stats;
use crate::columnar::{AnyCells, Cells, Column};
use parquet::data_type::ByteArray;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// The format that is written.
const FORMAT: &str = "v3.0";
/// What LeRobot shall call the robot.
const ROBOT: &str = "feeler";
/// Most files in a folder: LeRobot's own default.
const FILES_OF_A_CHUNK: usize = 1000;
/// Bytes of what LeRobot calls a megabyte.
const MEGABYTE: usize = 1 << 20;

/// How large a file gets before the next episode begins another one, MB of 2^20 bytes. An episode is never divided.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FileSizes {
    /// A file of rows.
    pub data: usize,
    /// A file of one camera's pictures.
    pub videos: usize,
}

impl Default for FileSizes {
    /// LeRobot's own.
    fn default() -> Self {
        Self {
            data: 100,
            videos: 200,
        }
    }
}

impl FileSizes {
    /// Whether a file of rows of so many bytes takes no further episode.
    pub(crate) fn is_full_of_data(self, bytes: usize) -> bool {
        bytes >= self.data * MEGABYTE
    }

    /// Whether a file of pictures of so many bytes takes no further episode.
    pub(crate) fn is_full_of_video(self, bytes: u64) -> bool {
        bytes >= (self.videos * MEGABYTE) as u64
    }
}

/// Where the file of this number is, by the folder it is in and its extension.
pub(crate) fn file_path(folder: &str, number: usize, extension: &str) -> String {
    let (chunk, file) = chunk_and_file(number);
    format!("{folder}/chunk-{chunk:03}/file-{file:03}.{extension}")
}

/// How LeRobot counts the file of this number.
pub(crate) fn chunk_and_file(number: usize) -> (usize, usize) {
    (number / FILES_OF_A_CHUNK, number % FILES_OF_A_CHUNK)
}

/// An episode as the data set lists it.
pub(crate) struct Episode {
    /// Name of its run, and digest of that's recording.
    pub run: String,
    /// Digest of the run's recording.
    pub digest: String,
    /// What it shows, in words.
    pub task: String,
    /// Frames.
    pub length: usize,
    /// The first of them among the frames of all episodes.
    pub from: usize,
    /// Number of the file of its rows.
    pub data_file: usize,
    /// Where the pictures of each feature are.
    pub videos: BTreeMap<String, VideoPlace>,
    /// Statistics of each feature.
    pub stats: BTreeMap<String, Stats>,
}

/// Where the pictures of an episode are.
#[derive(Debug, Clone, Copy)]
pub(crate) struct VideoPlace {
    /// Number of the file.
    pub file: usize,
    /// Time of its first picture in the file, and of its end, s.
    pub from: f64,
    /// Time of its end in the file, s.
    pub to: f64,
}

/// `info.json`: of the features each with its description.
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

/// `stats.json`: over all episodes.
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

/// `tasks.parquet`: a data frame of pandas, whose index are the tasks.
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

/// The file of episodes: a row for each.
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

/// The statistics of a feature, which has such ones in the first episode.
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
