"""Sweeps: many randomised trials of one experiment, on the cores of this computer or on a cluster."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from feeler import _core
from feeler._progress import progress_bar
from feeler._settings import Value, as_settings
from feeler.sensing import PathLike

if TYPE_CHECKING:
    import pandas
    import polars

Engine = Literal["threads", "ray"]

MAX_TRIALS = 100_000_000
MAX_JOBS = 1024


class Sweep:
    """The folder of a finished sweep, with its plan, table and summary page."""

    def __init__(self, folder: PathLike) -> None:
        """Opens the sweep in ``folder``.

        Raises
        ------
        FileNotFoundError
            If the folder does not contain a finished sweep.
        """
        self.folder = Path(folder)
        if not self.table_path.exists():
            raise FileNotFoundError(f"{self.folder}: expected the folder of a finished sweep, but it contains no trials.csv")

    @property
    def table_path(self) -> Path:
        """``trials.csv``."""
        return self.folder / "trials.csv"

    @property
    def summary_path(self) -> Path:
        """``summary.html``."""
        return self.folder / "summary.html"

    @cached_property
    def _columns(self) -> dict[str, NDArray[Any]]:
        return {name: _frozen(column) for name, column in _core.read_table(self.table_path).items()}

    def columns(self) -> dict[str, NDArray[Any]]:
        """Returns the table's columns by name, sorted by trial; each is read-only with shape ``(trials,)``.

        ``trial`` and ``seed`` are ``int64``, ``success`` is ``bool``. Numbers are ``float64`` in SI units, NaN if a trial has
        no value. Text columns such as ``outcome`` and ``reason`` are object arrays of ``str``.

        Raises
        ------
        OSError, ValueError
            If the table cannot be read.
        """
        return dict(self._columns)

    def to_pandas(self) -> pandas.DataFrame:
        """Returns the table as a ``pandas.DataFrame``. Needs pandas."""
        import pandas

        return pandas.DataFrame(self.columns())

    def to_polars(self) -> polars.DataFrame:
        """Returns the table as a ``polars.DataFrame``. Needs Polars."""
        import polars

        return polars.DataFrame(self.columns())

    @property
    def successes(self) -> int:
        """Number of successful trials, as defined in ``summary.html``."""
        return int(self._columns["success"].sum())

    def __len__(self) -> int:
        """Number of trials."""
        return len(self._columns["trial"])

    def __repr__(self) -> str:
        return f"Sweep({str(self.folder)!r}, {self.successes} of {len(self)} trials succeeded)"


def _frozen(column: NDArray[Any] | list[str]) -> NDArray[Any]:
    array = np.array(column, dtype=object) if isinstance(column, list) else column
    array.flags.writeable = False
    return array


def sweep(
    experiment: PathLike,
    *,
    trials: int = 1000,
    vary: Mapping[str, str | float] | None = None,
    settings: Mapping[str, Value] | None = None,
    sensing: str | None = None,
    seed: int = 0,
    out: PathLike = "sweep",
    engine: Engine = "threads",
    jobs: int | None = None,
    resume: bool = False,
    progress: bool | Callable[[float], None] = False,
    trials_per_task: int = 250,
) -> Sweep:
    """Runs many randomised trials of an experiment. Writes the same files as ``feeler sweep``, byte for byte.

    A trial depends only on ``seed`` and its number, so the table does not depend on the engine, the number of parallel
    trials or the machines. Finished trials are kept: after Ctrl-C or a failure, the same call with ``resume=True``
    continues the sweep.

    Parameters
    ----------
    experiment
        An experiment file, or the name of a built-in experiment.
    trials
        Number of trials, 1 to 100 million.
    vary
        Distributions from which each trial draws parameters, as in ``{"friction": "uniform(0.3,1.2)"}``. The book's page on
        sweeps lists names and distributions.
    settings
        Values of the experiment for all trials, as in ``{"control.slip_threshold": 2.5}``.
    sensing
        ``"image"`` (rendered images) or ``"direct"`` (forces plus noise); by default, the setting of the experiment.
    seed
        Random seed, 0 to 2**63 - 1, from which the seeds of all trials are derived.
    out
        Folder of the sweep, which must not contain a sweep yet unless ``resume`` is set.
    engine
        ``"threads"`` runs trials on this computer. ``"ray"`` runs them as tasks on a Ray cluster: the cluster that this
        process is connected to, otherwise one that ``ray.init()`` finds (``RAY_ADDRESS``, or one running on this computer),
        otherwise a local one on this computer's cores that runs until the process ends. All machines need the same version
        of feeler.
    jobs
        Maximum number of parallel trials, 1 to 1024; by default, one per core of this computer or the cluster.
    resume
        Continues the interrupted sweep in ``out``, which must have the same parameters.
    progress
        ``True`` shows a progress bar (by tqdm, if installed); a function is called with the number of finished trials.
    trials_per_task
        With Ray: maximum number of trials per task, at least 1. If a machine fails, its running tasks, at most one per core,
        are repeated. Tasks are smaller if the sweep would not occupy all cores otherwise.

    Raises
    ------
    ValueError
        If the experiment or ``vary`` is invalid, or differs from the sweep to resume.
    OSError
        If a file cannot be read or written.
    ImportError
        If ``engine="ray"`` and Ray is not installed.
    RuntimeError
        If the cluster failed, or one of its machines has another version of feeler.
    """
    _in_range("trials", trials, MAX_TRIALS)
    _in_range("trials_per_task", trials_per_task, MAX_TRIALS)
    if jobs is not None:
        _in_range("jobs", jobs, MAX_JOBS)
    if not 0 <= seed < 2**63:
        raise ValueError(f"seed = {seed}: expected 0 to {2**63 - 1}")
    folder = Path(out)
    lines = as_settings(settings)
    if sensing is not None:
        lines.append(f"sensing={sensing}")
    varied = [f"{name}={distribution}" for name, distribution in (vary or {}).items()]
    planned = _core.Trials.planned(str(experiment), lines, varied, seed, trials, folder if resume else None)
    match engine:
        case "threads":
            store = _core.Store(folder, planned, resume)
            with progress_bar(progress, "trials", trials) as watch:
                store.run(jobs, watch)
        case "ray":
            from feeler._ray import Cluster

            cluster = Cluster(planned, jobs, trials_per_task)
            store = _core.Store(folder, planned, resume)
            with progress_bar(progress, "trials", trials) as watch:
                cluster.run(store, watch)
        case _:
            raise ValueError(f'engine = {engine!r}: expected "threads" or "ray"')
    store.finish()
    return Sweep(folder)


def _in_range(name: str, value: int, most: int) -> None:
    if not 1 <= value <= most:
        raise ValueError(f"{name} = {value}: expected 1 to {most}")
