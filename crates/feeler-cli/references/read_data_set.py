"""Reads a data set step by step as LeRobot's reader does (0.6: `dataset_metadata.py`, `io_utils.py`, `dataset_reader.py`),
without LeRobot itself, which needs torch; prints what it finds as JSON."""

import json
import os
import sys
import tempfile
from pathlib import Path

os.environ["HF_HUB_OFFLINE"] = "1"
os.environ["HF_HOME"] = tempfile.mkdtemp()

import av
import datasets
import numpy as np
import pandas as pd

root = Path(sys.argv[1])
QUANTILES = {"q01": 0.01, "q10": 0.1, "q50": 0.5, "q90": 0.9, "q99": 0.99}

# Of the time of a picture, s.
TOLERANCE = 1e-4

# What `DatasetInfo` has, and nothing else: LeRobot warns of more.
KNOWN = {
    "codebase_version", "fps", "features", "total_episodes", "total_frames", "total_tasks", "chunks_size",
    "data_files_size_in_mb", "video_files_size_in_mb", "data_path", "video_path", "robot_type", "splits",
}  # fmt: skip


def load_nested(folder, features=None):
    paths = sorted(str(path) for path in (root / folder).glob("*/*.parquet"))
    return datasets.Dataset.from_parquet(paths, features=features)


def as_arrow(feature):
    """`get_hf_features_from_features`"""
    shape, dtype = tuple(feature["shape"]), feature["dtype"]
    if shape == (1,):
        return datasets.Value(dtype=dtype)
    if len(shape) == 1:
        return datasets.Sequence(length=shape[0], feature=datasets.Value(dtype=dtype))
    return (datasets.Array3D if len(shape) == 3 else datasets.Array2D)(shape=shape, dtype=dtype)


def stats_of(array):
    """`get_feature_stats`, with all values instead of a histogram."""
    rows = array.reshape(len(array), -1, array.shape[-1] if array.ndim > 1 else 1)
    rows = rows.reshape(-1, rows.shape[-1]).astype(np.float64)
    stats = {"min": rows.min(0), "max": rows.max(0), "mean": rows.mean(0), "std": rows.std(0)}
    quantiles = {name: np.quantile(rows, share, axis=0) for name, share in QUANTILES.items()}
    return {**stats, **quantiles, "count": np.array([len(array)])}


def aggregate(parts):
    """`aggregate_feature_stats`"""
    counts = np.stack([part["count"] for part in parts])
    means = np.stack([part["mean"] for part in parts])
    total = counts.sum(0)
    mean = (means * counts).sum(0) / total
    variances = np.stack([part["std"] ** 2 for part in parts])
    variance = ((variances + (means - mean) ** 2) * counts).sum(0) / total
    quantiles = {name: sum(part[name] * part["count"] for part in parts) / total for name in QUANTILES}
    return {
        "min": np.min([part["min"] for part in parts], axis=0),
        "max": np.max([part["max"] for part in parts], axis=0),
        "mean": mean,
        "std": np.sqrt(variance),
        "count": total,
        **quantiles,
    }


def apart(stats, expected):
    assert set(stats) == set(expected), stats.keys()
    return max(float(np.abs(np.array(stats[name]).ravel() - expected[name].ravel()).max()) for name in expected)


def video_frames(key):
    """`decode_video_frames`, of all frames of all episodes: each the one at its time, within LeRobot's tolerance."""
    found = []
    for episode in episodes:
        chunk, file = episode[f"videos/{key}/chunk_index"], episode[f"videos/{key}/file_index"]
        path = info["video_path"].format(video_key=key, chunk_index=chunk, file_index=file)
        with av.open(str(root / path)) as container:
            stream = container.streams.video[0]
            described = features[key]["info"]
            assert described["video.codec"] == stream.codec.canonical_name, stream.codec
            assert described["video.pix_fmt"] == stream.pix_fmt, stream.pix_fmt
            assert described["video.fps"] == stream.base_rate, stream.base_rate
            assert features[key]["shape"] == [stream.height, stream.width, 3], (stream.height, stream.width)
            decoded = {float(f.pts * stream.time_base): f.to_ndarray(format="rgb24") for f in container.decode(stream)}
        times = np.array(list(decoded))
        assert episode[f"videos/{key}/to_timestamp"] <= times[-1] + 1 / info["fps"] + TOLERANCE
        for index in range(episode["length"]):
            time = episode[f"videos/{key}/from_timestamp"] + index / info["fps"]
            nearest = times[np.abs(times - time).argmin()]
            assert abs(nearest - time) < TOLERANCE, (time, nearest)
            found.append(decoded[nearest])
    return np.stack(found)


info = json.loads((root / "meta/info.json").read_text())
assert set(info) == KNOWN, set(info) ^ KNOWN
features = info["features"]
videos = [key for key, feature in features.items() if feature["dtype"] == "video"]
columns = datasets.Features({key: as_arrow(f) for key, f in features.items() if key not in videos})
tasks = pd.read_parquet(root / "meta/tasks.parquet")
tasks.index.name = "task"
all_episodes = load_nested("meta/episodes")
episodes = all_episodes.select_columns([key for key in all_episodes.features if not key.startswith("stats/")])
frames = load_nested("data", columns)
stats = json.loads((root / "meta/stats.json").read_text())

values = {key: np.array(frames.with_format("numpy")[:][key]) for key in columns}
of_episode = [values["episode_index"] == index for index in range(info["total_episodes"])]
stats_apart = 0.0
for key in columns:
    parts = [stats_of(values[key][rows]) for rows in of_episode]
    stats_apart = max(stats_apart, apart(stats[key], aggregate(parts)))
    for row, part in zip(all_episodes, parts):
        kept = {name: row[f"stats/{key}/{name}"] for name in part}
        stats_apart = max(stats_apart, apart(kept, part))

pictures = {key: video_frames(key) for key in videos}

last = frames[len(frames) - 1]
print(
    json.dumps(
        {
            "info": {key: value for key, value in info.items() if key != "features"},
            "features": features,
            "tasks": {task: int(row.task_index) for task, row in tasks.iterrows()},
            "episodes": [dict(episode) for episode in episodes],
            "frames": len(frames),
            "types": {key: str(values[key].dtype) for key in columns},
            "values": {key: value.tolist() for key, value in values.items()},
            "last_task": tasks.iloc[last["task_index"]].name,
            # Mean over rows, for each frame and column; the largest difference between colours.
            "columns": {key: seen[..., 0].mean(axis=1).tolist() for key, seen in pictures.items()},
            "colour": max([int(np.ptp(seen, axis=-1).max()) for seen in pictures.values()], default=0),
            "stats_keys": sorted(stats),
            "stats_apart": stats_apart,
        }
    )
)
