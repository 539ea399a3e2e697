"""A single environment."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, cast

import gymnasium
import numpy as np
from numpy.typing import ArrayLike, NDArray

from feeler import _core
from feeler._settings import Value, as_settings
from feeler.gym.spaces import PICTURE_SHAPE, ActionKind, Observation, ObservationKind, Spaces, expressions
from feeler.sensing import PathLike


class TactileEnv(gymnasium.Env[Observation, NDArray[np.float64]]):
    """An environment that runs an experiment in episodes; each step is one control step.

    The experiment's task plans the motion (SEARCH, MOVE, RELEASE, RETURN). The agent replaces the control law: it receives
    the same data and chooses the motion of the fingertips, to which the usual limits apply. Rewards and info are computed from
    the simulated world's true state, which observations never contain; the book's page *Learning* describes them.

    Observations are flat (float32 [L], the fingers one after the other) or a dictionary of float32 arrays for F fingers of E
    elements and J joints: ``forces`` [F, E, 3] (N, in E_i), ``touch``, ``slip``, ``over`` [F] (0 or 1), ``grasp_force`` [F]
    (N), ``joint_angles`` [F, J] (rad), ``joint_velocities`` [F, J] (rad/s), ``last_action`` [F, 3] (m/s), ``planned_velocity``
    [F, 3] (m/s), ``towards_object`` [F, 3], ``reflex``, ``keep_grasp`` [F] (1 if the plan requests it, otherwise 0).
    Velocities and directions are in the fingertip's frame T.

    Actions are float64: velocities of the fingertips in T (``fingertip``) or W (``world``) [3F], m/s, or of the joints
    (``joints``) [JF], rad/s. Actions beyond the limits are clipped; non-finite ones raise an error.

    Environments can be pickled and copied, for example for joblib, Ray or multiprocessing. A copy repeats the steps of the
    current episode.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 100}  # noqa: RUF012 (as in the base class)

    def __init__(
        self,
        experiment: PathLike = "cap-closing",
        *,
        settings: Mapping[str, Value] | None = None,
        vary: Mapping[str, str] | None = None,
        action: ActionKind = "fingertip",
        observation: ObservationKind = "flat",
        render_mode: str | None = None,
    ) -> None:
        """Creates the environment; call :meth:`reset` to start an episode.

        Parameters
        ----------
        experiment
            An experiment file, or the name of a built-in experiment.
        settings
            Values of the experiment. Forces are sensed directly unless they contain ``{"sensing": "image"}``.
        vary
            Distributions from which each episode draws parameters, as in ``{"friction": "uniform(0.3,1.2)"}``. Names and
            distributions are those of sweeps. ``{"object": "random"}`` draws a random object for a gripper, as
            ``feeler compare grip`` does.
        action, observation
            Kind of actions and observations; see the class.
        render_mode
            ``"rgb_array"``, or ``None`` to disable rendering.

        Raises
        ------
        ValueError
            If the experiment is invalid, or no rewards are defined for its task.
        """
        if render_mode is not None and render_mode not in self.metadata["render_modes"]:
            raise ValueError(f"render_mode = {render_mode!r}: expected None or one of {self.metadata['render_modes']}")
        self.render_mode = render_mode
        self._made_of = (str(experiment), as_settings(settings), expressions(vary), action)
        self._environment = _core.SingleEnvironment(*self._made_of)
        self._episode: tuple[int, int] | None = None
        self._actions: list[NDArray[np.float64]] = []
        spec = self._environment.spec()
        self._spaces = Spaces(spec, observation)
        self.observation_space = cast("gymnasium.Space[Observation]", self._spaces.observation)
        self.action_space = self._spaces.action
        self.max_steps: int = spec.max_steps
        """Control steps after which an episode is truncated."""
        self.metadata = {**self.metadata, "render_fps": round(1.0 / spec.period)}
        self._info = np.empty(len(spec.info_names))

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Observation, dict[str, Any]]:
        """Begins the episode of ``seed``, or without a seed, the next episode that is derived from the last seed given.

        The seed alone determines the episode: varied parameters, noise and the cap's seat.
        """
        fresh = self._np_random_seed is None
        super().reset(seed=seed)
        if seed is None and fresh:
            # The first episode without any seed.
            seed = int(self.np_random.integers(2**63))
        flat = np.empty(self._spaces.length, dtype=np.float32)
        own = self._environment.reset(seed, flat, self._info)
        # The last seed given, and the index of this episode among those derived from it.
        given, following = self._episode or (own, -1)
        self._episode = (given, following + 1) if seed is None else (own, 0)
        self._actions = []
        return self._spaces.observe(flat), {"seed": own, **self._spaces.info(self._info)}

    def step(self, action: ArrayLike) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Runs one control step with ``action``.

        Raises
        ------
        ValueError
            If the action has another shape or a non-finite component.
        RuntimeError
            If no episode is in progress.
        """
        flat = np.empty(self._spaces.length, dtype=np.float32)
        numbers = np.ascontiguousarray(action, dtype=np.float64)
        if numbers.shape != self.action_space.shape:
            raise ValueError(f"action: expected float64 {list(self.action_space.shape or ())}, got {list(numbers.shape)}")
        reward, terminated, truncated = self._environment.step(numbers, flat, self._info)
        self._actions.append(numbers.copy())
        info: dict[str, Any] = self._spaces.info(self._info)
        if terminated and (reason := self._environment.stop_reason()) is not None:
            info["stop_reason"] = reason
        return self._spaces.observe(flat), reward, terminated, truncated, info

    def render(self) -> NDArray[np.uint8] | None:
        """Renders the scene (links, domes with elements coloured by force, objects) as uint8 [H, W, 3]."""
        if self.render_mode is None:
            return None
        picture = np.empty(PICTURE_SHAPE, dtype=np.uint8)
        self._environment.render(picture)
        return picture

    def guide(self) -> NDArray[np.float64]:
        """Returns the action that executes the task's plan."""
        action = np.empty(self.action_space.shape or ())
        self._environment.guide(action)
        return action

    def __getstate__(self) -> dict[str, Any]:
        """Returns the state of a copy. The current episode is stored as its seed and actions, which determine it."""
        return {name: value for name, value in self.__dict__.items() if name != "_environment"}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Recreates the environment, and repeats the current episode up to its latest step."""
        self.__dict__.update(state)
        self._environment = _core.SingleEnvironment(*self._made_of)
        if self._episode is None:
            return
        flat = np.empty(self._spaces.length, dtype=np.float32)
        info = np.empty_like(self._info)
        self._environment.reset_to(*self._episode, flat, info)
        for action in self._actions:
            self._environment.step(action, flat, info)
