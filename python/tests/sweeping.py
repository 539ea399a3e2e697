"""Helpers that start, compare and watch short sweeps."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import feeler

# About 30 ms per trial, until the first stroke.
SHORT: dict[str, Any] = {
    "sensing": "direct",
    "settings": {"time_limit": 4.0},
    "seed": 5,
    "vary": {"friction": "uniform(0.7,1.3)", "cap.radius": "normal(0.014,0.0001)"},
}
FILES = ("sweep.toml", "trials.csv", "summary.html")


def short(out: Path, **more: Any) -> feeler.Sweep:
    return feeler.sweep("cap-closing", out=out, **(SHORT | more))


def same(one: Path, other: Path) -> None:
    for name in FILES:
        assert (one / name).read_bytes() == (other / name).read_bytes(), name
    assert not (one / "trials.csv.part").exists()


def finished(folder: Path) -> int:
    """Returns the number of finished trials of a running sweep."""
    part = folder / "trials.csv.part"
    return max(0, part.read_bytes().count(b"\n") - 1) if part.exists() else 0


def wait_for(folder: Path, trials: int, process: subprocess.Popen[bytes] | None = None) -> None:
    """Waits until ``trials`` trials are finished; fails if ``process`` or the sweep ends first."""
    while finished(folder) < trials:
        assert process is None or process.poll() is None, "it ended by itself"
        assert not (folder / "trials.csv").exists(), "it was finished before anything was done to it"
        time.sleep(0.01)


def driver(out: Path, engine: str, trials: int) -> subprocess.Popen[bytes]:
    """Starts a separate process that runs a short sweep."""
    here = str(Path(__file__).parent)
    code = f"import sys; sys.path.insert(0, {here!r}); from sweeping import *\n"
    code += f"short(Path({str(out)!r}), engine={engine!r}, trials={trials}, trials_per_task=5)"
    return subprocess.Popen([sys.executable, "-c", code])
