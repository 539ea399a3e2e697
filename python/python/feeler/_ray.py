"""Sweeps on a Ray cluster: each task runs some trials on any machine, and this process stores their rows."""

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
        'engine="ray": Ray is not installed; install it here and on all machines of the cluster: pip install "feeler[ray]"'
    ) from error

# Maximum number of retries of a task whose machine or process failed.
MAX_RETRIES = 10
# Number of submitted tasks per core, so that no core waits for this process.
TASKS_AHEAD = 2
# Minimum number of tasks per core, so that no core idles for long at the end.
TASKS_PER_CPU = 4
# Interval at which signals are handled, s.
POLL = 0.05


def run_trials(version: str, plan: str, files: Mapping[str, bytes], trials: Sequence[int]) -> bytes:
    """Body of a task: runs the given trials of a plan (``sweep.toml``) that reads ``files``, and returns their table (CSV).

    Raises
    ------
    RuntimeError
        If another version of feeler is installed on this machine.
    """
    if _core.__version__ != version:
        raise RuntimeError(
            f"{socket.gethostname()}: expected feeler {version}, the version that started the sweep, "
            f"got {_core.__version__}: trials of another version may differ"
        )
    with TemporaryDirectory(prefix="feeler-sweep-") as folder:
        for name, content in files.items():
            path = Path(folder, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        rows: bytes = _core.Trials(plan, Path(folder) if files else None).run(trials)
    return rows


class Cluster:
    """A Ray cluster that runs the trials of a sweep."""

    def __init__(self, trials: _core.Trials, jobs: int | None, trials_per_task: int) -> None:
        """Connects to the cluster, to run ``trials`` with at most ``jobs`` tasks at a time.

        Raises
        ------
        OSError, ValueError
            If a file that the experiment names cannot be sent.
        ConnectionError
            If the configured cluster cannot be reached.
        """
        files: Mapping[str, bytes] = trials.files()
        if not ray.is_initialized():
            ray.init(include_dashboard=False, logging_level=logging.WARNING)
        self._task = ray.remote(max_retries=MAX_RETRIES)(run_trials)
        self._arguments = (_core.__version__, ray.put(trials.plan), ray.put(files))
        self._jobs = jobs
        self._trials_per_task = trials_per_task

    def run(self, store: _core.Store, progress: Callable[[float], None] | None) -> None:
        """Runs the trials missing in ``store``; ``progress`` is called with the number of finished trials."""
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
            # Empty unless an exception was raised.
            for task in running:
                ray.cancel(task)

    def _tasks(self, missing: list[int]) -> Iterator[list[int]]:
        """Splits the missing trials into tasks."""
        fair = math.ceil(len(missing) / (TASKS_PER_CPU * (self._jobs or self._cpus())))
        size = max(1, min(self._trials_per_task, fair))
        return (missing[start : start + size] for start in range(0, len(missing), size))

    @staticmethod
    def _cpus() -> int:
        resources: dict[str, float] = ray.cluster_resources()  # type: ignore[no-untyped-call]
        return max(1, int(resources.get("CPU", 1)))


def _rows(task: ray.ObjectRef[bytes]) -> bytes:
    """Returns the result of a task, or raises its exception as if it had run locally."""
    try:
        rows: bytes = ray.get(task)
    except ray.exceptions.RayTaskError as error:
        raise error.cause from None
    except ray.exceptions.RayError as error:
        raise RuntimeError(f"{error}; the finished trials are kept: continue with resume=True") from error
    return rows
