"""Sweeps as tasks of a Ray cluster: a task runs some trials anywhere, and this program keeps their rows."""

from __future__ import annotations

import logging
import math
import socket
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from feeler import _core

try:
    import ray
except ImportError as error:
    raise ImportError(
        'engine="ray": there is no Ray; expected it here and on all machines of the cluster: pip install "feeler[ray]"'
    ) from error

# How often a task is run again that its machine or process took with it.
MAX_RETRIES = 10
# Tasks under way for each core, so that none waits for this program.
TASKS_AHEAD = 2
# Tasks for each core at least, so that no core waits long for the others at the end.
TASKS_PER_CPU = 4
# How long a signal may wait for its handler, s.
POLL = 0.05


def run_trials(version: str, plan: str, files: Mapping[str, bytes], trials: Sequence[int]) -> bytes:
    """What a task does: runs these trials of a plan (``sweep.toml``) that reads ``files``; their table (CSV).

    Raises
    ------
    RuntimeError
        When feeler is of another version here.
    """
    if _core.__version__ != version:
        raise RuntimeError(
            f"{socket.gethostname()}: feeler {_core.__version__} is installed; expected {version}, as where the sweep "
            "was started: another version's trials may differ"
        )
    with TemporaryDirectory(prefix="feeler-sweep-") as folder:
        for name, content in files.items():
            path = Path(folder, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        rows: bytes = _core.Trials(plan, Path(folder) if files else None).run(trials)
    return rows


class Cluster:
    """The Ray cluster, with what its machines need to run a sweep's trials."""

    def __init__(self, trials: _core.Trials, jobs: int | None, trials_per_task: int) -> None:
        """For the trials ``trials``, at most ``jobs`` at a time.

        Raises
        ------
        OSError, ValueError
            When a file that the experiment names cannot be sent.
        ConnectionError
            When there should be a cluster but is none.
        """
        files: Mapping[str, bytes] = trials.files()
        if not ray.is_initialized():
            ray.init(include_dashboard=False, logging_level=logging.WARNING)
        self._task = ray.remote(max_retries=MAX_RETRIES)(run_trials)
        self._arguments = (_core.__version__, ray.put(trials.plan), ray.put(files))
        self._jobs = jobs
        self._trials_per_task = trials_per_task

    def run(self, store: _core.Store, progress: Callable[[float], None] | None) -> None:
        """Runs what ``store`` lacks; ``progress`` is called with the number of finished trials."""
        waiting = self._tasks(store.missing())
        running: list[ray.ObjectRef[bytes]] = []
        try:
            while True:
                # Machines may join and leave at any time.
                most = self._jobs or TASKS_AHEAD * self._cpus()
                while len(running) < most and (trials := next(waiting, None)):
                    running.append(self._task.remote(*self._arguments, trials))
                if not running:
                    return
                done, running = ray.wait(running, timeout=POLL)
                for task in done:
                    store.push(_rows(task))
                if progress:
                    progress(store.finished)
        finally:
            # Nothing is left of it unless something was raised.
            for task in running:
                ray.cancel(task)

    def _tasks(self, missing: list[int]) -> Iterator[list[int]]:
        """The trials of each task."""
        fair = math.ceil(len(missing) / (TASKS_PER_CPU * (self._jobs or self._cpus())))
        size = max(1, min(self._trials_per_task, fair))
        return (missing[start : start + size] for start in range(0, len(missing), size))

    @staticmethod
    def _cpus() -> int:
        resources: dict[str, float] = ray.cluster_resources()  # type: ignore[no-untyped-call]
        return max(1, int(resources.get("CPU", 1)))


def _rows(task: ray.ObjectRef[bytes]) -> bytes:
    """What a task returned; what it raised, as if it had run here."""
    try:
        rows: bytes = ray.get(task)
    except ray.exceptions.RayTaskError as error:
        raise error.cause from None
    except ray.exceptions.RayError as error:
        raise RuntimeError(f"{error}; the finished trials are kept: go on with resume=True") from error
    return rows
