"""Scores a Python object in the touch league: ``feeler league DATA --entry mine='python mine.py'``."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Protocol, TextIO

import numpy as np
from numpy.typing import ArrayLike, NDArray

VERSION = 1


@dataclass(frozen=True, slots=True)
class Course:
    """A data set and one of its splits."""

    set: str
    """Name of the data set."""
    task: str
    """``slip`` (a probability is predicted) or ``values`` (one number for each of ``targets``)."""
    per: str
    """``recording`` or ``row``: unit for which a prediction is made."""
    columns: tuple[str, ...]
    """Values of one element, such as x, y and z."""
    unit: str
    """Unit of the values."""
    targets: tuple[str, ...]
    """Names of the targets; empty for slip."""


@dataclass(frozen=True, slots=True)
class Sample:
    """A recording, or contiguous rows of one."""

    recording: int
    """Identifier; equal in rows of the same recording."""
    group: int | None
    """Identifier of the group, such as the object; ``None`` in test samples."""
    times: NDArray[np.float64]
    """Time of each row, s [N]."""
    rows: tuple[NDArray[np.float64], ...]
    """Values of each row, element by element; NaN if unknown. Rows of located markers may have different lengths."""
    truth: NDArray[np.float64] | None
    """Slip (0 or 1) [1] or [N], or targets [N, T]; NaN if unknown. ``None`` in test samples."""

    @property
    def values(self) -> NDArray[np.float64]:
        """All rows as one array [N, E * C], if they have the same length."""
        return np.array(self.rows)


class Entry(Protocol):
    """An object that can be scored. Each split uses a new process, and therefore a new object."""

    def fit(self, course: Course, train: list[Sample]) -> None:
        """Learns from the training samples."""

    def predict(self, sample: Sample) -> ArrayLike:
        """Returns the probability of slip (of the recording, or [N]), or the targets [N, T]."""


def _numbers(values: object) -> NDArray[np.float64]:
    return np.array(values, dtype=np.float64)  # None becomes NaN


def _sample(message: dict[str, Any]) -> Sample:
    truth = message.get("targets", message.get("slip"))
    return Sample(
        recording=message["recording"],
        group=message.get("group"),
        times=_numbers(message["times"]),
        rows=tuple(_numbers(row) for row in message["values"]),
        truth=None if truth is None else np.atleast_1d(_numbers(truth)),
    )


def serve(entry: Entry, questions: Iterable[str] = sys.stdin, answers: TextIO = sys.stdout) -> None:
    """Reads a split of a data set from ``questions``, and writes the predictions of ``entry`` to ``answers``.

    Raises
    ------
    ValueError
        If the first line is not from the league, or from another version of it, or if a prediction is not finite.
    """
    lines = iter(questions)
    header = json.loads(next(lines, "{}"))
    if header.get("protocol") != "feeler-league" or header.get("version") != VERSION:
        raise ValueError(f"expected a line of feeler league, version {VERSION}; start this program by feeler league --entry")
    course = Course(
        set=header["set"],
        task=header["task"],
        per=header["per"],
        columns=tuple(header["columns"]),
        unit=header["unit"],
        targets=tuple(target["name"] for target in header["targets"]),
    )
    entry.fit(course, [_sample(json.loads(next(lines))) for _ in range(header["train"])])
    for line in lines:
        message = json.loads(line)
        predicted = np.asarray(entry.predict(_sample(message)), dtype=np.float64)
        key = "slip" if course.task == "slip" else "targets"
        answer = float(predicted.reshape(())) if course.per == "recording" else predicted.tolist()
        print(json.dumps({"sample": message["sample"], key: answer}, allow_nan=False), file=answers, flush=True)
