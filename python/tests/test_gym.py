"""The Gymnasium environments."""

from __future__ import annotations

import copy
import multiprocessing
import os
import pickle
import warnings
from typing import Any

import feeler
import gymnasium
import numpy as np
import pytest
from feeler.gym import EXPERIMENTS, TactileEnv, TactileVectorEnv
from feeler.gym.sb3 import SB3VecEnv
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray
from test_runs import PaperLaw

SHORT: dict[str, feeler.Value] = {"time_limit": 0.5}


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_gymnasium_accepts_each_environment(name: str) -> None:
    env = gymnasium.make(f"feeler/{name}-v0", render_mode="rgb_array").unwrapped
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*not within.*")
        check_env(env)


@pytest.mark.parametrize("kind", ["flat", "dict"])
def test_observations_have_finite_bounds(kind: Any) -> None:
    env = TactileEnv("cap-closing", observation=kind)
    spaces = env.observation_space
    boxes = list(spaces.values()) if isinstance(spaces, gymnasium.spaces.Dict) else [spaces]
    for box in boxes:
        assert isinstance(box, gymnasium.spaces.Box) and np.isfinite(box.low).all() and np.isfinite(box.high).all()
    observation, _ = env.reset(seed=1)
    while env.observation_space.contains(observation):
        observation, _, terminated, truncated, _ = env.step(env.guide())
        if terminated or truncated:
            return
    pytest.fail("an observation out of its bounds")


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))])
def test_a_copy_behaves_like_the_original(copied: Any) -> None:
    env = TactileEnv("cap-closing", vary={"friction": "uniform(0.5,1.2)"}, settings={"time_limit": 3.0})
    env.reset(seed=4)
    env.reset()
    for _ in range(150):
        env.step(env.guide())
    other = copied(env)
    for _ in range(50):
        action = env.guide()
        np.testing.assert_array_equal(other.guide(), action)
        mine, others = env.step(action), other.step(action)
        np.testing.assert_array_equal(mine[0], others[0])
        assert mine[1:] == others[1:]
    # The following episodes are equal, too.
    assert env.reset()[1]["seed"] == other.reset()[1]["seed"]
    fresh = copied(TactileEnv("lift", settings=SHORT))
    np.testing.assert_array_equal(fresh.reset(seed=2)[0], TactileEnv("lift", settings=SHORT).reset(seed=2)[0])


def test_settings_may_be_nested() -> None:
    nested = TactileEnv(settings={"control": {"limits": {"fingertip_speed": 0.02}}, "time_limit": 1.0})
    flat = TactileEnv(settings={"control.limits.fingertip_speed": 0.02, "time_limit": 1.0})
    assert nested.action_space == flat.action_space
    assert nested.action_space != TactileEnv(settings={"time_limit": 1.0}).action_space
    with pytest.raises(ValueError, match=r"control\.touch_force = -1"):
        TactileEnv(settings={"control": {"touch_force": -1}})


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_following_the_plan_reaches_the_goal(name: str) -> None:
    env = TactileEnv(EXPERIMENTS[name])
    env.reset(seed=3)
    total = 0.0
    for _ in range(env.max_steps):
        _, reward, terminated, truncated, info = env.step(env.guide())
        total += reward
        if terminated or truncated:
            break
    assert terminated and "stop_reason" not in info
    # Units of the goals: N·s of about 9 that are carried, less the grip; mN·m, mm of the path, percent of the outline.
    assert total > (5 if name == "Grip" else 20)


def test_the_papers_law_as_an_agent_reproduces_the_run(closing: feeler.Run) -> None:
    recording = closing.recording
    control = recording.experiment["control"]
    env = TactileEnv("cap-closing", action="world", observation="dict")
    observation, _ = env.reset(seed=7)
    # Observations are float32, so the law uses the float64 readings of a parallel session.
    laws = [PaperLaw(control["recompression_speed"], control.get("minimum_grasp_force", 0.2)) for _ in range(2)]
    session = feeler.Session("cap-closing", seed=7, sensing="direct")
    row = 0
    for row, step in enumerate(session):
        assert isinstance(observation, dict)
        np.testing.assert_array_equal(observation["forces"], recording.force[row].astype(np.float32))
        np.testing.assert_array_equal(observation["joint_angles"], recording.joint_position[row].astype(np.float32))
        senses = zip(laws, step.plans, step.fingers, strict=True)
        action = np.array([law.velocity(plan, finger) for law, plan, finger in senses])
        step.move(action)
        if row < len(recording) - 1:
            observation, _, terminated, _, _ = env.step(np.ravel(action))
            # The task is done at the start of the run's last step.
            assert terminated == (row == len(recording) - 2)
    assert row == len(recording) - 1


def test_seeds_determine_episodes_and_what_varies_in_them() -> None:
    vary = {"friction": "uniform(0.4,1.2)"}

    def episode(seed: int) -> NDArray[np.float32]:
        env = TactileEnv("cap-closing", settings=SHORT, vary=vary)
        first, _ = env.reset(seed=seed)
        seen = [first]
        for _ in range(40):
            seen.append(env.step(env.guide())[0])
        return np.array(seen)

    np.testing.assert_array_equal(episode(1), episode(1))
    assert not np.array_equal(episode(1), episode(2))


def test_without_a_seed_environments_differ() -> None:
    envs = TactileVectorEnv(4, settings=SHORT)
    observations, _ = envs.reset()
    assert isinstance(observations, np.ndarray)
    assert len(np.unique(observations, axis=0)) == 4, "four episodes"


@pytest.mark.parametrize("threads", [1, 2, 3])
@pytest.mark.parametrize("mode", list(AutoresetMode))
def test_each_of_a_vector_is_a_single_one(threads: int, mode: AutoresetMode) -> None:
    count, steps = 5, 70  # longer than an episode of half a second
    random = np.random.default_rng(0)
    actions = random.uniform(-0.02, 0.02, (steps, count, 6))
    envs = TactileVectorEnv(count, settings=SHORT, threads=threads, autoreset_mode=mode)
    singles = [TactileEnv("cap-closing", settings=SHORT) for _ in range(count)]
    observations, _ = envs.reset(seed=11)
    expected = np.array([env.reset(seed=11 + i)[0] for i, env in enumerate(singles)])
    np.testing.assert_array_equal(observations, expected)
    over = np.zeros(count, dtype=np.bool_)
    for step in range(steps):
        if mode == AutoresetMode.DISABLED and over.any():
            observations, _ = envs.reset(options={"reset_mask": over})
            for i in np.flatnonzero(over).tolist():
                expected[i] = singles[i].reset()[0]
            np.testing.assert_array_equal(observations, expected)
            over = np.zeros(count, dtype=np.bool_)
        observations, rewards, terminated, truncated, infos = envs.step(actions[step])
        for i, env in enumerate(singles):
            if mode == AutoresetMode.NEXT_STEP and over[i]:
                expected[i], (reward, ended) = env.reset()[0], (0.0, False)
            else:
                single, reward, te, tr, _ = env.step(actions[step, i])
                expected[i], ended = single, te or tr
            if mode == AutoresetMode.SAME_STEP and ended:
                np.testing.assert_array_equal(infos["final_obs"][i], expected[i])
                assert infos["_final_obs"][i]
                expected[i] = env.reset()[0]
            assert rewards[i] == reward and (terminated[i] or truncated[i]) == ended
            over[i] = ended
        np.testing.assert_array_equal(observations, expected)
    if mode != AutoresetMode.DISABLED:
        assert envs.metadata["autoreset_mode"] == mode


def test_copy_controls_whether_arrays_are_overwritten() -> None:
    kept = TactileVectorEnv(2, settings=SHORT)
    first, _ = kept.reset(seed=1)
    before = np.array(first)
    kept.step(kept.guide())
    np.testing.assert_array_equal(first, before)
    shared = TactileVectorEnv(2, settings=SHORT, copy=False)
    first, _ = shared.reset(seed=1)
    assert isinstance(first, np.ndarray) and not first.flags.writeable
    second = shared.step(shared.guide())[0]
    assert isinstance(second, np.ndarray) and np.shares_memory(first, second)


def test_dictionaries_hold_the_same_numbers() -> None:
    flat, _ = TactileEnv("cap-closing").reset(seed=1)
    named, _ = TactileEnv("cap-closing", observation="dict").reset(seed=1)
    assert isinstance(named, dict) and isinstance(flat, np.ndarray)
    assert named["forces"].shape == (2, 41, 3) and named["touch"].shape == (2,)
    np.testing.assert_array_equal(flat[:123], named["forces"][0].ravel())
    assert sum(part.size for part in named.values()) == flat.size
    batch, _ = TactileVectorEnv(3, observation="dict").reset(seed=1)
    assert isinstance(batch, dict) and batch["forces"].shape == (3, 2, 41, 3)
    np.testing.assert_array_equal(batch["joint_angles"][0], named["joint_angles"])


def test_rendered_images_show_motion() -> None:
    env = TactileEnv("cap-closing", render_mode="rgb_array")
    env.reset(seed=1)
    before = env.render()
    for _ in range(300):
        env.step(env.guide())
    after = env.render()
    assert before is not None and after is not None and before.shape == after.shape == (360, 480, 3)
    # The fingers have moved to the cap; the background has not changed.
    changed = (before != after).any(axis=2).mean()
    assert 0.01 < changed < 0.5
    envs = TactileVectorEnv(2, render_mode="rgb_array")
    envs.reset(seed=1)
    pictures = envs.render()
    assert pictures is not None
    np.testing.assert_array_equal(pictures[0], before)
    assert TactileEnv("cap-closing").render() is None


def test_invalid_actions_are_rejected_with_a_message() -> None:
    env = TactileEnv("cap-closing", settings=SHORT)
    with pytest.raises(RuntimeError, match="no episode is active"):
        env.step(np.zeros(6))
    env.reset(seed=1)
    with pytest.raises(ValueError, match=r"action: expected float64 \[6\], got \[5\]"):
        env.step(np.zeros(5))
    with pytest.raises(ValueError, match=r"action\[2\]: expected a finite number, got NaN"):
        env.step([0, 0, np.nan, 0, 0, 0])
    env.step(np.full(6, 1e9))
    envs = TactileVectorEnv(2, settings=SHORT)
    envs.reset(seed=1)
    with pytest.raises(ValueError, match=r"environment 1: action\[0\]: expected a finite number"):
        envs.step([[0.0] * 6, [np.inf, 0, 0, 0, 0, 0]])


def test_invalid_options_are_rejected_with_a_message() -> None:
    cases: list[tuple[dict[str, Any], str]] = [
        ({"experiment": "nowhere"}, "no experiment"),
        ({"experiment": "friction-scan"}, "no rewards are defined for task.friction_scan"),
        ({"action": "torque"}, "action = .*: expected one of world, fingertip, joints"),
        ({"observation": "pixels"}, 'expected "flat" or "dict"'),
        ({"vary": {"friction": "gamma(1,2)"}}, "gamma"),
        ({"settings": {"no.such.key": 1}}, "no"),
        ({"render_mode": "ansi"}, "render_mode"),
    ]
    for options, words in cases:
        with pytest.raises(ValueError, match=words):
            TactileEnv(**options)
    with pytest.raises(ValueError, match="environments"):
        TactileVectorEnv(0)


def _step_in_child(envs: TactileVectorEnv, answer: Any) -> None:
    try:
        envs.step(np.zeros((2, 6)))
        answer.put("stepped")
    except RuntimeError as error:
        answer.put(str(error))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
def test_a_forked_process_gets_an_error_about_missing_threads() -> None:
    envs = TactileVectorEnv(2, settings=SHORT, threads=2)
    envs.reset(seed=1)
    context = multiprocessing.get_context("fork")
    answer = context.SimpleQueue()
    child = context.Process(target=_step_in_child, args=(envs, answer))
    child.start()
    words = answer.get()
    child.join()
    assert "before this process was forked" in words
    envs.step(np.zeros((2, 6)))


def test_the_interface_of_stable_baselines_is_implemented() -> None:
    envs = SB3VecEnv(3, experiment="cap-closing", settings=SHORT)
    assert envs.seed(5) == [5, 6, 7]
    observations = envs.reset()
    assert observations.shape == (3, 288) and len(envs.reset_infos) == 3
    over = np.zeros(3, dtype=np.bool_)
    for _ in range(60):
        envs.step_async(np.zeros((3, *envs.action_space.shape), dtype=np.float32))
        observations, rewards, over, infos = envs.step_wait()
        assert rewards.dtype == np.float32 and over.dtype == np.bool_ and len(infos) == 3
        if over.any():
            break
    assert over.all(), "half a second is over for all at once"
    for info in infos:
        assert info["TimeLimit.truncated"] and info["terminal_observation"].shape == observations[0].shape
    # The next episodes have started.
    assert not np.array_equal(observations[0], infos[0]["terminal_observation"])
    assert envs.env_is_wrapped(object) == [False] * 3 and envs.get_attr("num_envs", 0) == [3]
    envs.close()
