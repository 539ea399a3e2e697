"""Sweeps on threads: the program's files, columns, Ctrl-C, resuming."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
from pathlib import Path
from typing import Any

import feeler
import numpy as np
import pytest
from conftest import EXPERIMENTS, the_program
from feeler import _core
from sweeping import driver, finished, same, short, wait_for


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> feeler.Sweep:
    return short(tmp_path_factory.mktemp("sweeps") / "swept", trials=12)


def test_the_files_are_the_programs(swept: feeler.Sweep, tmp_path: Path) -> None:
    options = ["--sensing=direct", "--set=time_limit=4.0", "--seed=5", "--trials=12", "--jobs=1"]
    vary = ["--vary=friction=uniform(0.7,1.3)", "--vary=cap.radius=normal(0.014,0.0001)"]
    command = [the_program(), "sweep", "cap-closing", *options, *vary, "-o=theirs"]
    subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    same(tmp_path / "theirs", swept.folder)


def test_columns_are_what_the_table_says(swept: feeler.Sweep) -> None:
    columns = swept.columns()
    header, *rows = (line.split(",") for line in swept.table_path.read_text().splitlines())
    assert list(columns) == header and all(len(column) == 12 for column in columns.values())
    np.testing.assert_array_equal(columns["trial"], np.arange(12))
    assert columns["seed"].tolist() == [int(row[1]) for row in rows]
    assert columns["friction"].tolist() == [float(row[2]) for row in rows]
    assert set(columns["outcome"]) == {"time_limit"} and columns["success"].dtype == np.bool_
    assert np.isnan(columns["stroke2.peak_torque"]).all(), "no trial reached stroke 2"
    assert not any(column.flags.writeable for column in columns.values())
    assert len(swept) == 12 and swept.successes == 0 and "0 of 12 trials succeeded" in repr(swept)
    assert swept.summary_path.stat().st_size > 10_000
    pandas, polars = swept.to_pandas(), swept.to_polars()
    np.testing.assert_array_equal(pandas["stroke1.peak_torque"], columns["stroke1.peak_torque"])
    assert polars["outcome"].to_list() == columns["outcome"].tolist()


def test_progress_is_reported(tmp_path: Path) -> None:
    told: list[float] = []
    short(tmp_path / "sweep", trials=8, jobs=1, progress=told.append)
    assert told == sorted(told) and told[-1] == 8


def test_a_sweep_can_be_resumed_after_ctrl_c(swept: feeler.Sweep, tmp_path: Path) -> None:
    folder = tmp_path / "sweep"

    def interrupt(done: float) -> None:
        if done >= 2 and not sent:
            sent.append(done)
            os.kill(os.getpid(), signal.SIGINT)

    sent: list[float] = []
    with pytest.raises(KeyboardInterrupt):
        short(folder, trials=12, jobs=1, progress=interrupt)
    assert 2 <= finished(folder) < 12
    with pytest.raises(FileNotFoundError, match="finished sweep"):
        feeler.Sweep(folder)
    with pytest.raises(ValueError, match="already contains a sweep"):
        short(folder, trials=12)
    with pytest.raises(ValueError, match="its seed is 5, not 6; expected the interrupted sweep"):
        short(folder, trials=12, seed=6, resume=True)
    short(folder, trials=12, resume=True)
    same(folder, swept.folder)


def test_a_sweep_can_be_resumed_after_a_kill(tmp_path: Path) -> None:
    folder = tmp_path / "sweep"
    killed = driver(folder, "threads", 100)
    wait_for(folder, 5, killed)
    killed.kill()
    killed.wait()
    assert not (folder / "trials.csv").exists()
    same(short(folder, trials=100, resume=True).folder, short(tmp_path / "whole", trials=100).folder)


def test_trials_are_the_same_where_only_plan_and_files_are(tmp_path: Path) -> None:
    """Runs trials as a cluster machine does, for an experiment that reads a calibration and a mesh."""
    home, away = tmp_path / "home", tmp_path / "away"
    (home / "parts").mkdir(parents=True)
    calibration = "reference-fingertip.calibration.toml"
    shutil.copy(EXPERIMENTS / calibration, home / "parts")
    text = (EXPERIMENTS / "cap-closing.toml").read_text() + MESHED
    (home / "experiment.toml").write_text(text)
    (home / "parts/stone.stl").write_text(TETRAHEDRON)
    settings = [f'sensor.calibration="parts/{calibration}"', "time_limit=0.05"]
    trials = _core.Trials.planned(str(home / "experiment.toml"), settings, [], 0, 2, None)
    files = trials.files()
    assert sorted(files) == [f"parts/{calibration}", "parts/stone.stl"]
    for name, content in files.items():
        (away / name).parent.mkdir(parents=True, exist_ok=True)
        (away / name).write_bytes(content)
    rows = trials.run([0, 1])
    assert rows.count(b",time_limit,") == 2, "the files are read"
    shutil.rmtree(home)
    assert _core.Trials(trials.plan, away).run([0, 1]) == rows
    assert b",invalid," in trials.run([0])


# A mesh that the fingers do not touch.
MESHED = """
[sim.object.stone]
position = [0.3, 0.3, 0.0]
motion = "fixed"
shape.mesh = { file = "parts/stone.stl", scale = 0.001 }
"""
TETRAHEDRON = (
    "solid stone\n"
    + "".join(
        "facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {corner}\n" for corner in face) + "endloop\nendfacet\n"
        for face in (
            ("0 0 0", "0 9 0", "9 0 0"),
            ("0 0 0", "9 0 0", "0 0 9"),
            ("0 0 0", "0 0 9", "0 9 0"),
            ("9 0 0", "0 9 0", "0 0 9"),
        )
    )
    + "endsolid stone\n"
)


@pytest.mark.parametrize(
    ("wrong", "expected"),
    [
        ({"trials": 0}, "trials = 0: expected 1 to 100000000"),
        ({"jobs": 0}, "jobs = 0: expected 1 to 1024"),
        ({"trials_per_task": 0}, "trials_per_task = 0: expected 1"),
        ({"seed": -1}, "seed = -1: expected 0 to"),
        ({"engine": "spark"}, 'engine = \'spark\': expected "threads" or "ray"'),
        ({"vary": {"frictoin": "uniform(0,1)"}}, 'there is no parameter "frictoin"'),
        ({"vary": {"friction": "uniform(2,1)"}}, "the first must not exceed the second"),
        ({"settings": {"control.slip_threshold": -1}}, "expected more than 0"),
    ],
)
def test_invalid_arguments_are_rejected_with_a_message(wrong: dict[str, Any], expected: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError) as refused:
        short(tmp_path / "sweep", **wrong)
    assert expected in str(refused.value)
    assert not (tmp_path / "sweep").exists()


def test_an_invalid_table_is_rejected_with_a_message(swept: feeler.Sweep, tmp_path: Path) -> None:
    torn = tmp_path / "trials.csv"
    torn.write_bytes(swept.table_path.read_bytes()[:-40] + b"\n")
    with pytest.raises(ValueError, match="expected the table of a finished sweep"):
        feeler.Sweep(tmp_path).columns()
    with pytest.raises(IndexError, match="trial 7: expected 0 to 2 of 3 trials"):
        _core.Trials.planned("cap-closing", [], [], 0, 3, None).run([7])


def test_a_store_has_one_user_at_a_time(tmp_path: Path) -> None:
    trials = _core.Trials.planned("cap-closing", ["sensing=direct"], [], 0, 4, None)
    store = _core.Store(tmp_path / "sweep", trials, False)
    with pytest.raises(RuntimeError, match="4 trials are missing, starting with trial 0"):
        store.finish()
    said: list[str] = []

    def ask(_: float) -> None:
        try:
            store.missing()
        except RuntimeError as error:
            said.append(str(error))

    store.run(1, ask)
    assert set(said) == {"the sweep is already running on another thread"}
    store.finish()
    with pytest.raises(RuntimeError, match="the sweep is finished"):
        store.push(b"")
