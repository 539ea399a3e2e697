"""Runs the learning examples end to end with tiny budgets, and compares the included policy with the law `best`."""

from __future__ import annotations

import csv
import importlib.util
import re
import shutil
import signal
import subprocess
import sys
from functools import partial
from pathlib import Path
from typing import Any

import feeler
import numpy as np
import pytest
from conftest import EXPERIMENTS, missing, the_program
from feeler.gym import TactileEnv

EXAMPLES = Path(__file__).parents[2] / "examples/python"
POLICY = EXAMPLES / "cap-closing.safetensors"
GRIP_POLICIES = {touch: EXAMPLES / f"grip-{touch}.safetensors" for touch in ("touch", "blind")}
NO_TIME = ["--demonstrations=2", "--rounds=2", "--steps=5", "--pairs=2", "--checks=2", "--every=1"]


def needs(*packages: str) -> None:
    for package in packages:
        if importlib.util.find_spec(package) is None:
            missing(package)


def example(name: str, *arguments: str | Path) -> list[str]:
    return [sys.executable, "-u", str(EXAMPLES / name), *map(str, arguments)]


def run(name: str, *arguments: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(example(name, *arguments), capture_output=True, text=True, timeout=300)


def load(name: str) -> Any:
    """Imports an example as a module."""
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    assert spec is not None and spec.loader is not None
    script = importlib.util.module_from_spec(spec)
    sys.modules[name] = script
    spec.loader.exec_module(script)
    return script


def is_a_policy(path: Path) -> bool:
    """Returns ``True`` if the control loop accepts the policy."""
    settings: dict[str, feeler.Value] = {"control.law.policy.file": str(path), "time_limit": 2.0}
    session = feeler.Session("cap-closing", sensing="direct", settings=settings)
    return sum(1 for _ in session) > 100 and session.phase != "STOPPED"


@pytest.fixture(scope="module")
def trained(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """Trains a policy for some seconds and returns its file and the output."""
    needs("jax", "flax", "optax", "safetensors")
    out = tmp_path_factory.mktemp("trained") / "my.safetensors"
    done = run("train_policy.py", "-o", out, *NO_TIME, "--generations=1")
    assert done.returncode == 0, done.stderr
    return out, done.stdout


def test_training_writes_a_policy_that_the_control_loop_accepts(trained: tuple[Path, str]) -> None:
    out, told = trained
    assert re.search(r"imitation 1: teacher [\d.]+ mN·m", told) and "generation 1:" in told
    assert is_a_policy(out)
    assert [path.name for path in out.parent.iterdir()] == [out.name], "nothing is left beside it"


def test_an_existing_policy_is_kept_without_force(trained: tuple[Path, str]) -> None:
    out, _ = trained
    before = out.read_bytes()
    refused = run("train_policy.py", "-o", out)
    assert refused.returncode == 1 and "already exists; expected a new file, or --force" in refused.stderr
    assert out.read_bytes() == before
    forced = run("train_policy.py", "-o", out, "--force", *NO_TIME, "--generations=0", "--seed=1")
    assert forced.returncode == 0 and out.read_bytes() != before


def test_ctrl_c_keeps_the_best_policy_so_far(tmp_path: Path) -> None:
    needs("jax", "flax", "optax", "safetensors")
    out = tmp_path / "my.safetensors"
    command = example("train_policy.py", "-o", out, *NO_TIME, "--generations=1000")
    # Shells start background commands with SIGINT ignored, and child processes inherit that.
    accept = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, preexec_fn=accept) as training:
        assert training.stdout is not None
        for line in training.stdout:
            if "generation 1:" in line:
                break
        training.send_signal(signal.SIGINT)
        rest, _ = training.communicate(timeout=120)
    assert training.returncode == 0 and "interrupted" in rest
    assert is_a_policy(out)


def test_the_hand_is_symmetric_as_training_assumes() -> None:
    """On a centred cap without noise, both fingers have the same readings, rotated by half a turn about the cap's axis."""
    needs("jax", "flax", "optax", "safetensors")
    script = load("train_policy")
    still = {"sim.variation.bottle_position": 0.0, "sim.variation.friction": 0.0, "sim.servo.encoder_resolution": 1e-9}
    quiet = {"sim.direct_sensing.normal_noise": 0.0, "sim.direct_sensing.shear_noise": 0.0}
    env = TactileEnv("cap-closing", settings=still | quiet)
    observation, _ = env.reset(seed=1)
    grasped = 0
    for _ in range(350):
        assert isinstance(observation, np.ndarray)
        one, other = observation.reshape(2, script.INPUTS)
        # float32, and rounding of two kinematic chains that stick-slip amplifies.
        np.testing.assert_allclose(other, one[script.INDEX] * script.SIGN, atol=1e-4)
        grasped += one[script.KEEP_GRASP] > 0
        observation, *_ = env.step(env.guide())
    assert grasped > 50


def test_the_law_is_tuned(tmp_path: Path) -> None:
    needs("cma")
    done = run("tune_law.py", "--caps=2", "--population=4", "--generations=1", "--held-out=4")
    assert done.returncode == 0, done.stderr
    table = re.search(r"(\[control\.law\.best\]\n(?:\w+ = [\d.]+\n)+)", done.stdout)
    assert table and "cap by cap" in done.stdout
    shutil.copytree(EXPERIMENTS, tmp_path / "experiments")
    own = tmp_path / "experiments/own.toml"
    own.write_text((EXPERIMENTS / "cap-closing.toml").read_text() + "\n" + table[1])
    assert feeler.Session(own, settings={"time_limit": 0.1}, sensing="direct").phase == "SEARCH"


def test_both_examples_tighten_the_caps_of_feeler_compare(tmp_path: Path) -> None:
    needs("jax", "flax", "optax", "safetensors", "cma")
    tuning, training = load("tune_law"), load("train_policy")
    assert tuning.CAPS == training.CAPS and tuning.SETTINGS.items() <= training.SETTINGS.items()
    command = [the_program(), "compare", "cap-closing", "--laws=best", "--trials=3", "--seed=5", "--out=compared"]
    compared = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert compared.returncode == 0, compared.stderr
    with (tmp_path / "compared/best/trials.csv").open(encoding="utf-8") as table:
        expected = [1e3 * float(row["cap_torque"]) for row in csv.DictReader(table)]
    torque, _ = tuning.tighten({"control.law": "best"}, caps=3, seed=5)
    np.testing.assert_allclose(torque, expected, rtol=1e-9)


def test_the_included_policy_performs_as_documented() -> None:
    """On 1,000 caps, the policy reaches 1.9 mN·m more than `best`, with 0.003 N less on the most loaded element. Per cap, the
    differences have standard deviations of 3.9 mN·m and 0.035 N, so their means over 48 caps have standard errors of 0.6 mN·m
    and 0.005 N."""
    tighten = load("tune_law").tighten
    torque, peak = tighten({"control.law.policy.file": str(POLICY)}, caps=48, seed=77)
    best_torque, best_peak = tighten({"control.law": "best"}, caps=48, seed=77)
    assert POLICY.stat().st_size < 60_000
    assert (torque - best_torque).mean() > 1.9 - 3 * 0.6
    assert (peak - best_peak).mean() < -0.003 + 3 * 0.005
    assert peak.max() < 0.63, "no-damage"


def grip_settings(policy: Path) -> dict[str, feeler.Value]:
    return {"control.law.policy.file": str(policy), "task.grip.law": "policy"}


def test_training_without_touch_differs_only_in_its_inputs(tmp_path: Path) -> None:
    needs("jax", "flax", "optax", "safetensors")
    from safetensors.numpy import load_file

    script = load("train_grip_policy")
    for name, more in (("touch", []), ("blind", ["--blind"])):
        out = tmp_path / f"{name}.safetensors"
        done = run("train_grip_policy.py", "-o", out, "--objects=2", "--rounds=2", "--steps=5", *more)
        assert done.returncode == 0, done.stderr
        assert re.search(r"round 1: known-friction puts down \d+ % of 2 objects", done.stdout)
        assert "round 2: policy puts down" in done.stdout
        session = feeler.Session("grip", settings={**grip_settings(out), "time_limit": 3.0})
        assert sum(1 for _ in session) > 100 and session.phase != "STOPPED"
        for file in (out, GRIP_POLICIES[name]):
            weights = load_file(file)["layer0.weight"]
            felt, own = weights[:, : script.TOUCH_INPUTS], weights[:, script.OWN_INPUTS]
            assert np.any(felt) == (name == "touch") and np.all(np.any(own, axis=0)), file
    refused = run("train_grip_policy.py", "-o", out)
    assert refused.returncode == 1 and "already exists; expected a new file, or --force" in refused.stderr


def test_training_sees_what_a_policy_sees_in_the_control_loop() -> None:
    """The script computes the plan of a policy itself, because the environment's plan is the demonstration."""
    needs("jax", "flax", "optax", "safetensors")
    script = load("train_grip_policy")
    trained: list[Any] = []

    def still(x: Any, _wanted: Any, shown: Any) -> Any:
        trained.append((x[0], shown[0]))
        return np.full(x.shape[:2], 0.0005)

    objects = script.Objects(1, "known-friction")
    objects.grip([5], still)
    env = TactileEnv("grip", vary={"object": "random"}, settings=grip_settings(GRIP_POLICIES["touch"]))
    observation, info = env.reset(seed=5)
    held, planned = 0, 0.0
    for x, shown in trained:
        assert isinstance(observation, np.ndarray)
        action = env.guide()
        if info["phase"] == script.MOVE:
            expected = observation.reshape(2, script.INPUTS)
            # Rounding may change positions by steps of the encoder, 1 µm, and then which elements stick.
            for part in (script.JOINT, script.PLANNED):
                np.testing.assert_allclose(x[:, part], expected[:, part], atol=1e-5)
            planned = max(planned, abs(float(expected[0, script.PLANNED])))
            held += shown
            action[::3] += 0.0005
        observation, *_, info = env.step(action)
    assert held > 200 and planned > 3e-4


def test_the_gripper_is_symmetric_as_training_assumes() -> None:
    needs("jax", "flax", "optax", "safetensors")
    script = load("train_grip_policy")
    forces = np.random.default_rng(1).normal(size=(script.ELEMENTS, 3))
    observation = np.zeros(script.INPUTS)
    observation[: 3 * script.ELEMENTS] = forces.ravel()
    in_fingertip = np.einsum("eij,ej->ei", script.FRAMES, forces)
    for axis in (1, 2):
        index, sign = script.mirrored(axis)
        mirrored = (observation[index] * sign)[: 3 * script.ELEMENTS].reshape(-1, 3)
        image = np.einsum("eij,ej->ei", script.FRAMES, mirrored)
        mirror = np.where(np.arange(3) == axis, -1.0, 1.0)
        for tip, force in zip(script.FINGERTIP.tips, in_fingertip, strict=True):
            there = np.linalg.norm(script.FINGERTIP.tips - tip * mirror, axis=1).argmin()
            np.testing.assert_allclose(image[there], force * mirror, atol=1e-6)
