"""Shared fixtures: runs, and paths of the repository's files."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import feeler
import numpy as np
import pytest
from numpy.typing import NDArray

EXPERIMENTS = Path(__file__).parents[2] / "crates/feeler-lab/experiments"
CALIBRATION = EXPERIMENTS / "reference-fingertip.coupled.calibration.toml"


def missing(what: str) -> None:
    """Skips a test because ``what`` is missing, or fails it if FEELER_REQUIRE_ALL=1."""
    if os.environ.get("FEELER_REQUIRE_ALL") == "1":
        pytest.fail(f"{what} is missing, and FEELER_REQUIRE_ALL=1")
    pytest.skip(f"SKIPPED for want of {what}")


def the_program() -> str:
    """Returns the path of the program built in this clone, or of the installed one."""
    target = Path(os.environ.get("CARGO_TARGET_DIR", EXPERIMENTS.parents[2] / "target"))
    built = [path for profile in ("debug", "release") if (path := target / profile / "feeler").exists()]
    newest = max(built, key=lambda path: path.stat().st_mtime, default=shutil.which("feeler"))
    if newest is None:
        missing("the program feeler (cargo build -p feeler-cli)")
    return str(newest)


@pytest.fixture(scope="session")
def pictured(tmp_path_factory: pytest.TempPathFactory) -> feeler.Run:
    """A run with rendered, recorded images that include contact."""
    folder = tmp_path_factory.mktemp("runs") / "pictured"
    settings: dict[str, feeler.Value] = {"time_limit": 3.0}
    return feeler.run("cap-closing", seed=3, sensing="image", settings=settings, out=folder, record_frames=True)


@pytest.fixture(scope="session")
def frames(pictured: feeler.Run) -> NDArray[np.uint8]:
    """Frames of finger 0 in that run [N, H, W]."""
    return pictured.recording.frames(0)[0]


@pytest.fixture(scope="session")
def closing(tmp_path_factory: pytest.TempPathFactory) -> feeler.Run:
    """The reference experiment, sensed directly."""
    folder = tmp_path_factory.mktemp("runs") / "closing"
    return feeler.run("cap-closing", seed=7, sensing="direct", out=folder)
