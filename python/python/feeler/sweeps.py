"""Sweeps: many randomised trials of one experiment, on the cores of this computer or on many computers."""

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
    """A finished sweep in its folder: plan, table, page."""

    def __init__(self, folder: PathLike) -> None:
        """The sweep that is in ``folder``.

        Raises
        ------
        FileNotFoundError
            When there is none, or it is not finished.
        """
        self.folder = Path(folder)
        if not self.table_path.exists():
            raise FileNotFoundError(f"{self.folder}: no trials.csv in it; expected the folder of a finished sweep")

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
        """The table's columns by name, shape ``(trials,)`` each, read-only, sorted by trial.

        ``trial`` and ``seed`` are ``int64``, ``success`` is ``bool``, and numbers are ``float64`` in SI units, not a
        number where a trial has none. Columns of words, as ``outcome`` and ``reason``, are object arrays of ``str``.

        Raises
        ------
        OSError, ValueError
            When the table cannot be read.
        """
        return dict(self._columns)

    def to_pandas(self) -> pandas.DataFrame:
        """The table as a ``pandas.DataFrame``, which needs pandas."""
        import pandas

        return pandas.DataFrame(self.columns())

    def to_polars(self) -> polars.DataFrame:
        """The table as a ``polars.DataFrame``, which needs Polars."""
        import polars

        return polars.DataFrame(self.columns())

    @property
    def successes(self) -> int:
        """How many trials were a success, as ``summary.html`` defines it."""
        return int(self._columns["success"].sum())

    def __len__(self) -> int:
        """How many trials there are."""
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
    """Runs many randomised trials of an experiment, as ``feeler sweep`` does: the same files, byte for byte.

    A trial depends on ``seed`` and its own number alone, so that the table does not depend on the engine, on how many
    trials run at a time, or on where. Each trial that finished is kept: after Ctrl-C, or whatever else ended the
    sweep, the same call with ``resume=True`` goes on with it.

    Parameters
    ----------
    experiment
        An experiment file, or the name of a built-in experiment.
    trials
        Number of trials, 1 to 100 million.
    vary
        Parameters and what each trial draws them from, as in ``{"friction": "uniform(0.3,1.2)"}``; see the book's page
        on sweeps for names and distributions.
    settings
        Values of the experiment for all trials, as in ``{"control.slip_threshold": 2.5}``.
    sensing
        ``"image"`` (rendered pictures) or ``"direct"`` (forces plus noise); the experiment's if left out.
    seed
        Random seed, 0 to 2**63 - 1; the seed of each trial follows from it.
    out
        The sweep's folder, which must not hold a sweep yet unless ``resume`` is set.
    engine
        ``"threads"`` of this computer, or ``"ray"``: tasks on the Ray cluster that this program is connected to, else
        on that which ``ray.init()`` finds (``RAY_ADDRESS``, or one that was started on this computer), else on one of
        this computer's cores, which goes on until the program ends. All its machines need the same version of feeler.
    jobs
        Trials at a time, 1 to 1024; one for each core, here or of the cluster, if left out.
    resume
        Go on with the sweep that was stopped in ``out``, which must be the same.
    progress
        Show a bar (by tqdm, where it is installed), or a function that is called with the number of finished trials.
    trials_per_task
        With Ray: most trials of one task, from 1. What a machine was doing when it failed is done again, a task at most
        for each of its cores. There are fewer where the sweep is too small to occupy all cores otherwise.

    Raises
    ------
    ValueError
        When the experiment, or what is to vary in it, cannot be used, or differs from that of the sweep to go on with.
    OSError
        When a file cannot be read or written.
    ImportError
        When ``engine="ray"`` and Ray is not installed.
    RuntimeError
        When the cluster could not go on, or one of its machines has another version of feeler.
    """
    _in_range("trials", trials, MAX_TRIALS)
    _in_range("trials_per_task", trials_per_task, MAX_TRIALS)
    if jobs is not None:
        _in_range("jobs", jobs, MAX_JOBS)
    if not 0 <= seed < 2**63:
        raise ValueError(f"seed = {seed}; expected 0 to {2**63 - 1}")
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
            raise ValueError(f'engine = {engine!r}; expected "threads" or "ray"')
    store.finish()
    return Sweep(folder)


def _in_range(name: str, value: int, most: int) -> None:
    if not 1 <= value <= most:
        raise ValueError(f"{name} = {value}; expected 1 to {most}")
