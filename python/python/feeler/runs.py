"""Runs of an experiment, with recording and report."""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Callable, Mapping
from functools import cached_property
from html import escape
from pathlib import Path
from typing import Any

from feeler import _core
from feeler._progress import progress_bar
from feeler._settings import Value, as_settings
from feeler.recordings import Recording, read
from feeler.sensing import PathLike


class Run:
    """The folder of a run, with its recording, report and summary."""

    def __init__(self, folder: PathLike) -> None:
        """Opens the run in ``folder``.

        Raises
        ------
        FileNotFoundError
            If the folder does not contain a run.
        """
        self.folder = Path(folder)
        if not self.recording_path.exists():
            raise FileNotFoundError(f"{self.folder}: expected the folder of a run, but it contains no recording.mcap")

    @property
    def recording_path(self) -> Path:
        """``recording.mcap``."""
        return self.folder / "recording.mcap"

    @property
    def report_path(self) -> Path:
        """``report.html``."""
        return self.folder / "report.html"

    @cached_property
    def summary(self) -> Mapping[str, Any]:
        """Content of ``summary.json``: claims, strokes, findings."""
        text = (self.folder / "summary.json").read_text(encoding="utf-8")
        summary: dict[str, Any] = json.loads(text)
        return summary

    @cached_property
    def recording(self) -> Recording:
        """The recording, as columns."""
        return read(self.recording_path)

    @property
    def figures(self) -> dict[str, Path]:
        """The report's figures (SVG), by name."""
        return {path.stem: path for path in sorted((self.folder / "figures").glob("*.svg"))}

    def __getattr__(self, name: str) -> Any:
        """A column of the recording: ``run.force``, ``run.torque``."""
        if name.startswith("_") or name not in Recording.COLUMNS:
            raise AttributeError(f"a run has no {name!r}; expected one of {', '.join(Recording.COLUMNS)}")
        return getattr(self.recording, name)

    def __repr__(self) -> str:
        claims = self.summary.get("claims") or self.summary.get("hand_claims") or []
        held = sum(bool(claim["holds"]) for claim in claims)
        verdict = f"{held} of {len(claims)} claims pass" if claims else self.summary.get("outcome") or self.summary["state"]
        return f"Run({str(self.folder)!r}, {self.summary.get('sim_time')} s, {verdict})"

    def _repr_html_(self) -> str:
        """Shows the figures and a link to the report in a notebook."""
        figures = "".join(_as_html(path) for path in self.figures.values())
        link = f"<a href='{escape(self.report_path.as_posix())}'>report</a>"
        return f"<p>{escape(repr(self))}: {link}, with the scene in 3-D</p>{figures}"


def _as_html(figure: Path) -> str:
    """Renders a figure with its title, two per row. An ``img`` scales to the available width and isolates the SVG's ids."""
    svg = figure.read_bytes()
    found = re.search(rb"<title[^>]*>(.*?)</title>", svg, re.DOTALL)
    title = found[1].decode() if found else escape(figure.stem)
    source = f"data:image/svg+xml;base64,{base64.b64encode(svg).decode()}"
    return (
        "<figure style='display:inline-block;vertical-align:top;box-sizing:border-box;width:49%;margin:0;padding:4px'>"
        f"<figcaption>{title}</figcaption><img style='width:100%' alt='' src='{source}'></figure>"
    )


def run(
    experiment: PathLike,
    *,
    seed: int | None = None,
    sensing: str | None = None,
    settings: Mapping[str, Value] | None = None,
    out: PathLike | None = None,
    record_frames: bool = False,
    progress: bool | Callable[[float], None] = False,
) -> Run:
    """Runs an experiment, records it and writes its report, like ``feeler run``.

    Ctrl-C ends the run. Its recording up to then is kept, and :func:`report` can write a report of it.

    Parameters
    ----------
    experiment
        An experiment file, or the name of a built-in experiment.
    seed
        Random seed; by default, the seed of the experiment.
    sensing
        ``"image"`` (rendered images) or ``"direct"`` (forces plus noise); by default, the setting of the experiment.
    settings
        Values of the experiment, as in ``{"control.slip_threshold": 2.5}``.
    out
        Folder of the run, which must not contain a run yet; by default ``runs/NAME-SENSING-seedN``.
    record_frames
        Records the camera frames, too.
    progress
        ``True`` shows a progress bar (by tqdm, if installed); a function is called with the simulated time, s.

    Raises
    ------
    ValueError
        If the experiment is invalid; the message names the key, its value and the valid values.
    OSError
        If a file cannot be read or written.
    RuntimeError
        If the run failed.
    """
    lines = as_settings(settings)
    if seed is not None:
        lines.append(f"seed={int(seed)}")
    if sensing is not None:
        lines.append(f"sensing={sensing}")
    with progress_bar(progress, "s simulated") as watch:
        outcome = _core.run(str(experiment), lines, out and Path(out), record_frames, watch)
    return Run(outcome.folder)


def report(folder: PathLike) -> Run:
    """Recreates the report of the run in ``folder`` from its recording.

    Raises
    ------
    OSError, RuntimeError
        If the recording is unreadable, or a file cannot be written.
    """
    _core.report(Path(folder))
    return Run(folder)
