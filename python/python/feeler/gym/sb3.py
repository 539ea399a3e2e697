"""Vector environment for Stable-Baselines3."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from feeler.gym.tactile_vector_env import TactileVectorEnv

if TYPE_CHECKING:
    Base = object
else:
    try:
        from stable_baselines3.common.vec_env import VecEnv as Base
    except ImportError:
        Base = object

Indices = int | Iterable[int] | None


class SB3VecEnv(Base):
    """A :class:`TactileVectorEnv` for Stable-Baselines3: ``PPO("MlpPolicy", SB3VecEnv(num_envs=64, experiment="lift"))``.

    Actions are scaled: -1 to 1 maps to the range of the environment's action space, as the algorithms expect.
    """

    def __init__(self, num_envs: int, **options: Any) -> None:
        """Creates the environments; ``options`` as for :class:`TactileVectorEnv`, except ``autoreset_mode`` and ``copy``."""
        from gymnasium import spaces

        self.environments = TactileVectorEnv(num_envs, autoreset_mode=AutoresetMode.SAME_STEP, **options)
        box = self.environments.single_action_space
        assert isinstance(box, spaces.Box)
        self._bounds = box.high
        self.num_envs = num_envs
        self.observation_space = self.environments.single_observation_space
        self.action_space = spaces.Box(-1.0, 1.0, box.shape, np.float32)
        self.render_mode: str | None = None
        self.metadata = self.environments.metadata
        self.reset_infos: list[dict[str, Any]] = [{} for _ in range(num_envs)]
        self._seed: int | None = None
        self._actions: NDArray[np.float64] | None = None

    def seed(self, seed: int | None = None) -> list[int | None]:
        """Sets the seeds for the next :meth:`reset`."""
        self._seed = seed
        return [None if seed is None else seed + i for i in range(self.num_envs)]

    def reset(self) -> Any:
        """Begins an episode in each environment."""
        observations, infos = self.environments.reset(seed=self._seed)
        self._seed = None
        self.reset_infos = self._rows(infos)
        return observations

    def step_async(self, actions: NDArray[Any]) -> None:
        """Stores the actions [num_envs, 3F], -1 to 1, for the next :meth:`step_wait`."""
        self._actions = np.asarray(actions, dtype=np.float64) * self._bounds

    def step_wait(self) -> tuple[Any, NDArray[np.float32], NDArray[np.bool_], list[dict[str, Any]]]:
        """Runs the step and returns observations, rewards, dones and infos."""
        if self._actions is None:
            raise RuntimeError("step_wait: call step_async first")
        observations, rewards, terminated, truncated, infos = self.environments.step(self._actions)
        self._actions = None
        over = terminated | truncated
        rows = self._rows(infos)
        for index in np.flatnonzero(over).tolist():
            rows[index]["terminal_observation"] = infos["final_obs"][index]
            rows[index]["TimeLimit.truncated"] = bool(truncated[index] and not terminated[index])
        return observations, rewards.astype(np.float32), over, rows

    def step(self, actions: NDArray[Any]) -> tuple[Any, NDArray[np.float32], NDArray[np.bool_], list[dict[str, Any]]]:
        """Runs :meth:`step_async` and :meth:`step_wait`."""
        self.step_async(actions)
        return self.step_wait()

    def close(self) -> None:
        """Ends the threads."""
        self.environments.close()

    def get_attr(self, attr_name: str, indices: Indices = None) -> list[Any]:
        """Returns the attribute of the shared object once per environment."""
        return [getattr(self.environments, attr_name)] * len(self._numbers(indices))

    def set_attr(self, attr_name: str, value: Any, indices: Indices = None) -> None:
        """Not supported, because all environments are one object."""
        raise NotImplementedError(f"{attr_name}: the environments are one object; create them with other options")

    def env_method(self, method_name: str, *arguments: Any, indices: Indices = None, **options: Any) -> list[Any]:
        """Not supported, because all environments are one object."""
        raise NotImplementedError(f"{method_name}: the environments are one object; call its methods")

    def env_is_wrapped(self, wrapper_class: type[Any], indices: Indices = None) -> list[bool]:
        """Returns ``False`` for each environment: none is wrapped."""
        return [False] * len(self._numbers(indices))

    def _numbers(self, indices: Indices) -> Sequence[int]:
        if indices is None:
            return range(self.num_envs)
        return [indices] if isinstance(indices, int) else list(indices)

    def _rows(self, infos: dict[str, Any]) -> list[dict[str, Any]]:
        names = [name for name, values in infos.items() if isinstance(values, np.ndarray) and values.dtype == np.float64]
        table = np.stack([infos[name] for name in names], axis=1).tolist()
        return [dict(zip(names, row, strict=True)) for row in table]
