"""Vector environment whose environments are stepped together, on native threads."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import ArrayLike, NDArray

from feeler import _core
from feeler._arrays import checked, read_only
from feeler._settings import Value, as_settings
from feeler.gym.spaces import PICTURE_SHAPE, ActionKind, Observation, ObservationKind, Spaces, expressions
from feeler.sensing import BoolArray, FloatArray, PathLike


class TactileVectorEnv(VectorEnv[Observation, FloatArray, NDArray[Any]]):
    """A vector of ``num_envs`` environments. Each gives the same results as a :class:`TactileEnv` with the same seed."""

    def __init__(
        self,
        num_envs: int = 1,
        experiment: PathLike = "cap-closing",
        *,
        settings: Mapping[str, Value] | None = None,
        vary: Mapping[str, str] | None = None,
        action: ActionKind = "fingertip",
        observation: ObservationKind = "flat",
        threads: int | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        copy: bool = True,
        render_mode: str | None = None,
    ) -> None:
        """Creates the environments; call :meth:`reset` to start episodes.

        Parameters
        ----------
        num_envs
            Number of environments.
        experiment, settings, vary, action, observation
            As for :class:`TactileEnv`.
        threads
            Number of threads; by default, the number of available processors.
        autoreset_mode
            When an environment begins a new episode after the end of one: in the next step, in the same step
            (``infos["final_obs"]`` contains the last observation), or by ``reset(options={"reset_mask": ...})`` only.
        copy
            ``True`` returns new arrays from each step. ``False`` returns read-only views that the next step overwrites.
        render_mode
            ``"rgb_array"``, or ``None`` to disable rendering.

        Raises
        ------
        ValueError
            If the experiment is invalid, or no rewards are defined for its task.
        """
        mode = AutoresetMode(autoreset_mode)
        if render_mode not in (None, "rgb_array"):
            raise ValueError(f'render_mode = {render_mode!r}: expected None or "rgb_array"')
        self.render_mode = render_mode
        self._environments = _core.ManyEnvironments(
            str(experiment),
            as_settings(settings),
            expressions(vary),
            action,
            num_envs,
            _processors() if threads is None else threads,
            mode.value,
        )
        spec = self._environments.spec()
        self._spaces = Spaces(spec, observation)
        self.num_envs = num_envs
        self.single_observation_space = self._spaces.observation
        self.single_action_space = self._spaces.action
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.metadata = {"autoreset_mode": mode, "render_modes": ["rgb_array"], "render_fps": round(1.0 / spec.period)}
        self.max_steps: int = spec.max_steps
        self._mode = mode
        self._copy = copy
        self._results = self._empty()

    def _empty(self) -> tuple[NDArray[np.float32], FloatArray, BoolArray, BoolArray, FloatArray]:
        count = self.num_envs
        return (
            np.zeros((count, self._spaces.length), dtype=np.float32),
            np.zeros(count),
            np.zeros(count, dtype=np.bool_),
            np.zeros(count, dtype=np.bool_),
            np.zeros((count, len(self._spaces.info_names))),
        )

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Observation, dict[str, Any]]:
        """Begins an episode in each environment, or in each with ``True`` in ``options["reset_mask"]``.

        Parameters
        ----------
        seed
            One seed per environment, or a number ``s``, which gives environment i the seed ``s + i``. Without seeds, episodes
            are derived from the last seeds given.
        options
            ``{"reset_mask": bool [num_envs]}``.
        """
        fresh = self._np_random_seed is None
        super().reset(seed=seed if isinstance(seed, int) else None)
        if seed is None and fresh:
            # The first episodes without any seeds.
            seeds: list[int | None] = self.np_random.integers(2**62, size=self.num_envs).tolist()
        elif seed is None:
            seeds = [None] * self.num_envs
        elif isinstance(seed, int):
            seeds = [seed + i for i in range(self.num_envs)]
        else:
            seeds = list(seed)
            _ = self.np_random
        mask = (options or {}).get("reset_mask")
        if mask is not None:
            mask = checked('options["reset_mask"]', mask, np.bool_, (self.num_envs,))
        self._environments.reset(seeds, mask, self._results)
        return self._observations(), self._infos()

    def step(self, actions: ArrayLike) -> tuple[Observation, FloatArray, BoolArray, BoolArray, dict[str, Any]]:
        """Runs one control step in each environment.

        Raises
        ------
        ValueError
            If ``actions`` is not [num_envs, 3F], or has a non-finite component.
        RuntimeError
            If an environment failed; the message names it and the reason.
        """
        numbers = np.ascontiguousarray(actions, dtype=np.float64)
        if numbers.shape != self.action_space.shape:
            raise ValueError(f"actions: expected float64 {list(self.action_space.shape or ())}, got {list(numbers.shape)}")
        self._environments.step(numbers, self._results)
        _, rewards, terminated, truncated, _ = self._results
        infos = self._infos()
        if self._mode == AutoresetMode.SAME_STEP:
            self._add_last(infos)
        if self._copy:
            return self._observations(), rewards.copy(), terminated.copy(), truncated.copy(), infos
        return self._observations(), _view(rewards), _view(terminated), _view(truncated), infos

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """Renders the scene of each environment, like :meth:`TactileEnv.render`."""
        if self.render_mode is None:
            return None
        pictures = np.empty((self.num_envs, *PICTURE_SHAPE), dtype=np.uint8)
        for index, picture in enumerate(pictures):
            self._environments.render(index, picture)
        return tuple(pictures)

    def guide(self) -> FloatArray:
        """Returns the actions [num_envs, 3F] that execute the tasks' plans."""
        actions = np.empty(self.action_space.shape or ())
        self._environments.guide(actions)
        return actions

    def _observations(self) -> Observation:
        flat = self._results[0]
        if self._spaces.kind == "dict":
            return self._spaces.observe(flat)
        return flat.copy() if self._copy else _view(flat)

    def _infos(self) -> dict[str, Any]:
        table = self._results[4].copy() if self._copy else _view(self._results[4])
        return {name: table[:, column] for column, name in enumerate(self._spaces.info_names)}

    def _add_last(self, infos: dict[str, Any]) -> None:
        """Adds the last observations and infos of the episodes that ended in this step, in Gymnasium's format."""
        over = self._results[2] | self._results[3]
        if not over.any():
            return
        observations = np.full(self.num_envs, None, dtype=object)
        numbers = np.full((self.num_envs, len(self._spaces.info_names)), np.nan)
        for index in np.flatnonzero(over).tolist():
            flat = np.empty(self._spaces.length, dtype=np.float32)
            if self._environments.last(index, flat, numbers[index]):
                observations[index] = self._spaces.observe(flat)
        infos["final_obs"], infos["_final_obs"] = observations, over.copy()
        infos["final_info"] = {name: numbers[:, column] for column, name in enumerate(self._spaces.info_names)}
        infos["_final_info"] = over.copy()

    def close_extras(self, **kwargs: Any) -> None:
        """Ends the threads."""
        del self._environments


def _processors() -> int:
    """Number of processors available to this process."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _view(array: NDArray[Any]) -> NDArray[Any]:
    return read_only(array[...])
