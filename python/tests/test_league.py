"""The touch league with a Python object."""

from __future__ import annotations

import csv
import io
import json
import subprocess
import sys
from pathlib import Path

import feeler.league
import numpy as np
import pytest
from conftest import the_program

ENTRY = """
import numpy as np
import feeler.league

class Offset:
    def fit(self, course, train):
        assert course.targets == ("f_z",) and course.columns == ("x", "y", "z")
        x = np.concatenate([sample.values[:, 2] for sample in train])
        y = np.concatenate([sample.truth[:, 0] for sample in train])
        known = np.isfinite(y)
        self.slope = (x[known] @ y[known]) / (x[known] @ x[known])

    def predict(self, sample):
        assert sample.truth is None and sample.group is None
        return sample.values[:, 2:3] * self.slope

feeler.league.serve(Offset())
"""

DEFINITION = """
version = 1
name = "pillar"
title = "A pillar whose column z is twice the force"
source = "this test"
licence = "MIT"
split = { by = "group", folds = 3 }

[values]
metric = "rmse"
targets = [{ name = "f_z", column = "newtons", unit = "N" }]

[values.taxels]
tables = "run-*.csv"
targets = "scale-*.csv"
time = "time"

[values.taxels.layout]
version = 1
name = "pillar"
unit = "counts"
columns = { x = "p{n}_x", y = "p{n}_y", z = "p{n}_z", time = { column = "t", unit = "s" } }
taxel = [{ place = [0.0, 0.0, 0.0] }]
"""


def test_an_object_learns_and_predicts(tmp_path: Path) -> None:
    for run in range(3):
        times = np.arange(40) * 0.1
        force = 1.0 + np.sin(times + run)
        rows = [f"{t:.1f},0,0,{2 * f:.6f}" for t, f in zip(times, force, strict=True)]
        (tmp_path / f"run-{run}.csv").write_text("t,p0_x,p0_y,p0_z\n" + "\n".join(rows) + "\n")
        rows = [f"{t:.1f},{f:.6f}" for t, f in zip(times, force, strict=True)]
        (tmp_path / f"scale-{run}.csv").write_text("time,newtons\n" + "\n".join(rows) + "\n")
    (tmp_path / "pillar.league.toml").write_text(DEFINITION)
    (tmp_path / "offset.py").write_text(ENTRY)
    entry = f"offset='{sys.executable}' '{tmp_path / 'offset.py'}'"
    out = tmp_path / "league"
    command = [the_program(), "league", str(tmp_path), "--set", "pillar", "--entry", entry, "-o", str(out)]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stdout + ended.stderr
    with (out / "league.csv").open() as table:
        errors = {row["entry"]: float(row["value"]) for row in csv.DictReader(table)}
    # Rounded to six decimals.
    assert errors["offset"] < 1e-5 < errors["constant"]


def test_another_first_line_is_refused() -> None:
    class Nothing:
        def fit(self, course: feeler.league.Course, train: list[feeler.league.Sample]) -> None: ...

        def predict(self, sample: feeler.league.Sample) -> float:
            return 0.5

    with pytest.raises(ValueError, match="feeler league"):
        feeler.league.serve(Nothing(), ["{}\n"], io.StringIO())
    with pytest.raises(ValueError, match="version 1"):
        feeler.league.serve(Nothing(), [json.dumps({"protocol": "feeler-league", "version": 2})], io.StringIO())
