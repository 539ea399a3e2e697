"""One environment."""

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
    """An experiment as episodes, a control step at a time.

    The experiment's task runs inside and plans (SEARCH, MOVE, RELEASE, RETURN); the agent stands where the control law does: it
    gets what a law gets, and says how the fingertips are to move. What it says passes the limits that every command passes.
    Rewards and info are of the simulated world's true state, which observations never contain; the page *Learning* of the book
    says what they are and why.

    Observations are flat (float32 [L], one finger's numbers after the other's) or a dictionary of float32 arrays for F fingers
    of E elements: ``forces`` [F, E, 3] (N, in E_i), ``touch``, ``slip``, ``over`` [F] (0 or 1), ``grasp_force`` [F] (N),
    ``joint_angles`` [F, 3] (rad), ``joint_velocities`` [F, 3] (rad/s), ``last_action`` [F, 3] (m/s), ``planned_velocity``
    [F, 3] (m/s), ``towards_object`` [F, 3], ``reflex``, ``keep_grasp`` [F] (0 or 1: whether the plan asks for it). Velocities
    and directions are in the fingertip's frame T.

    Actions are float64 [3F]: velocities of the fingertips in T (``fingertip``) or W (``world``), m/s, or of the joints
    (``joints``), rad/s. What exceeds the limits is clipped; what is not finite is refused.

    It can be pickled and copied, as for processes of joblib, Ray or multiprocessing. The copy makes the steps of the episode
    under way again.
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
        """The environment, before its first episode.

        Parameters
        ----------
        experiment
            A built-in experiment, or a file.
        settings
            Values of it. Forces are sensed directly unless ``{"sensing": "image"}`` is among them.
        vary
            What each episode draws anew, as in ``{"friction": "uniform(0.3,1.2)"}``; names and distributions are those of
            sweeps.
        action, observation
            What the numbers mean; see the class.
        render_mode
            ``"rgb_array"``, or None for none.

        Raises
        ------
        ValueError
            When the experiment cannot be used, or there are no rewards for its task.
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
        """Begins the episode of ``seed``, or the next of those that follow from the last seed given.

        The seed alone determines the episode: what varies in it, noise, where the cap seats.
        """
        fresh = self._np_random_seed is None
        super().reset(seed=seed)
        if seed is None and fresh:
            # The first episode of an environment that nobody gave a seed.
            seed = int(self.np_random.integers(2**63))
        flat = np.empty(self._spaces.length, dtype=np.float32)
        own = self._environment.reset(seed, flat, self._info)
        # The seed last given, and which of the episodes that follow from it this is.
        given, following = self._episode or (own, -1)
        self._episode = (given, following + 1) if seed is None else (own, 0)
        self._actions = []
        return self._spaces.observe(flat), {"seed": own, **self._spaces.info(self._info)}

    def step(self, action: ArrayLike) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Makes a control step in which the fingers do what ``action`` says.

        Raises
        ------
        ValueError
            When the action has another shape or a number that is not finite.
        RuntimeError
            When there is no episode under way.
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
        """A picture of the scene: links, domes with their elements coloured by force, objects; uint8 [H, W, 3]."""
        if self.render_mode is None:
            return None
        picture = np.empty(PICTURE_SHAPE, dtype=np.uint8)
        self._environment.render(picture)
        return picture

    def guide(self) -> NDArray[np.float64]:
        """The action that follows the task's plan."""
        action = np.empty(self.action_space.shape or ())
        self._environment.guide(action)
        return action

    def __getstate__(self) -> dict[str, Any]:
        """What a copy is made of: an episode under way is its seed and its actions, which determine it."""
        return {name: value for name, value in self.__dict__.items() if name != "_environment"}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Makes the environment again, and the episode under way up to its newest step."""
        self.__dict__.update(state)
        self._environment = _core.SingleEnvironment(*self._made_of)
        if self._episode is None:
            return
        flat = np.empty(self._spaces.length, dtype=np.float32)
        info = np.empty_like(self._info)
        self._environment.reset_to(*self._episode, flat, info)
        for action in self._actions:
            self._environment.step(action, flat, info)
