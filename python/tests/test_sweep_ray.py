"""Sweeps on a Ray cluster of two nodes give the same files, even if a node or the driver is killed."""

from __future__ import annotations

import logging
import os
import shutil
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import feeler
import pytest
from conftest import CALIBRATION, EXPERIMENTS, missing
from sweeping import driver, finished, same, short, wait_for

TRIALS = 60
# One processor each, with the minimum memory that Ray accepts.
NODE = {"num_cpus": 1, "object_store_memory": 80_000_000}


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    """A connected local cluster that consists of a head node."""
    try:
        import ray
        from ray.cluster_utils import Cluster
    except ImportError:
        missing("Ray (pip install ray)")
    # A node counts as dead after 5 s of silence instead of 30 s.
    system = {"health_check_period_ms": 500, "health_check_failure_threshold": 10}
    head = {**NODE, "include_dashboard": False, "_system_config": system}
    cluster: Any = Cluster(initialize_head=True, head_node_args=head)
    ray.init(address=cluster.address, logging_level=logging.WARNING)
    yield cluster
    ray.shutdown()
    cluster.shutdown()


@pytest.fixture
def second(cluster: Any) -> Iterator[Any]:
    """A second node."""
    node = cluster.add_node(**NODE)
    cluster.wait_for_nodes()
    yield node
    if node in cluster.list_all_nodes():
        cluster.remove_node(node)


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same sweep on threads."""
    return short(tmp_path_factory.mktemp("sweeps") / "threads", trials=TRIALS).folder


@pytest.mark.parametrize("trials_per_task", [1, 7, 250])
def test_the_files_are_the_same_for_any_split(trials_per_task: int, cluster: Any, expected: Path, tmp_path: Path) -> None:
    told: list[float] = []
    swept = short(tmp_path / "ray", engine="ray", trials=TRIALS, trials_per_task=trials_per_task, progress=told.append)
    same(swept.folder, expected)
    assert told == sorted(told) and told[-1] == TRIALS


def test_a_node_that_is_killed_changes_nothing(cluster: Any, second: Any, tmp_path: Path) -> None:
    folder, whole = tmp_path / "ray", tmp_path / "threads"

    def kill() -> None:
        wait_for(folder, 10)
        cluster.remove_node(second, allow_graceful=False)

    killer = threading.Thread(target=kill, daemon=True)
    killer.start()
    # Enough trials that both nodes are busy when one is killed.
    short(folder, engine="ray", trials=300, trials_per_task=5)
    killer.join()
    assert second not in cluster.list_all_nodes()
    same(folder, short(whole, trials=300).folder)


def test_a_sweep_can_be_resumed_after_its_driver_is_killed(
    cluster: Any, second: Any, expected: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "ray"
    monkeypatch.setenv("RAY_ADDRESS", cluster.address)
    killed = driver(folder, "ray", TRIALS)
    wait_for(folder, 5, killed)
    killed.kill()
    killed.wait()
    before = finished(folder)
    assert 5 <= before < TRIALS
    told: list[float] = []
    short(folder, engine="ray", trials=TRIALS, resume=True, progress=told.append)
    assert told[0] >= before, "what was finished is not run again"
    same(folder, expected)


def test_threads_can_resume_a_sweep_after_ctrl_c(cluster: Any, expected: Path, tmp_path: Path) -> None:
    folder = tmp_path / "ray"
    sent: list[float] = []

    def interrupt(done: float) -> None:
        if done >= 2 and not sent:
            sent.append(done)
            os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        short(folder, engine="ray", trials=TRIALS, trials_per_task=2, jobs=1, progress=interrupt)
    assert 2 <= finished(folder) < TRIALS
    short(folder, trials=TRIALS, resume=True)
    same(folder, expected)


def test_files_of_the_experiment_are_sent_to_the_machines(cluster: Any, tmp_path: Path) -> None:
    shutil.copy(EXPERIMENTS / "cap-closing.toml", tmp_path / "own.toml")
    shutil.copy(CALIBRATION, tmp_path / "mine.toml")
    settings: dict[str, feeler.Value] = {"sensor.calibration": "mine.toml", "time_limit": 0.05}
    options: dict[str, Any] = {"trials": 4, "settings": settings, "sensing": "image"}
    one, two = tmp_path / "threads", tmp_path / "ray"
    feeler.sweep(tmp_path / "own.toml", out=one, **options)
    same(feeler.sweep(tmp_path / "own.toml", out=two, engine="ray", **options).folder, one)
    assert set(feeler.Sweep(two).columns()["outcome"]) == {"time_limit"}
    settings["sensor.calibration"] = str(tmp_path / "mine.toml")
    with pytest.raises(ValueError, match="expected a file in the experiment's folder or below"):
        feeler.sweep(tmp_path / "own.toml", out=tmp_path / "none", engine="ray", **options)
    assert not (tmp_path / "none").exists()


def test_a_machine_with_another_version_is_rejected_with_a_message(
    cluster: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("feeler._core.__version__", "0.0.0")
    with pytest.raises(RuntimeError, match=r"expected feeler 0\.0\.0, the version that started the sweep, got \d+\.\d+\.\d+"):
        short(tmp_path / "ray", engine="ray", trials=3)


def test_missing_ray_is_reported(tmp_path: Path) -> None:
    code = "import sys; sys.modules['ray'] = None; import feeler\n"
    code += "try: feeler.sweep('cap-closing', engine='ray')\nexcept ImportError as error: print(error)"
    said = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, check=True, capture_output=True, text=True)
    assert "Ray is not installed" in said.stdout and "pip install" in said.stdout
    assert not list(tmp_path.iterdir())
