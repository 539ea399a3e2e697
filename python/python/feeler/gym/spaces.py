"""Observation and action spaces of the environments."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from feeler import _core
from feeler._environments import EXPERIMENTS

__all__ = ["EXPERIMENTS", "PICTURE_SHAPE", "ActionKind", "Observation", "ObservationKind", "Spaces"]

ActionKind = Literal["fingertip", "world", "joints"]
ObservationKind = Literal["flat", "dict"]
Observation = NDArray[np.float32] | dict[str, NDArray[np.float32]]

PICTURE_SHAPE = (360, 480, 3)
"""Rows, columns and colour channels of a rendered image."""


class Spaces:
    """Spaces of an environment, and conversion of flat observations to dictionaries."""

    def __init__(self, spec: _core.EnvironmentSpec, kind: ObservationKind) -> None:
        if kind not in ("flat", "dict"):
            raise ValueError(f'observation = {kind!r}: expected "flat" or "dict"')
        self.kind = kind
        self.parts = spec.parts
        self.fingers = len(spec.parts)
        self.length = spec.parts[-1][-1][3]
        self.info_names = spec.info_names
        bounds = np.array(spec.action_bounds)
        self.action = spaces.Box(-bounds, bounds, dtype=np.float64)
        self._low, self._high = (np.array(bound, dtype=np.float32) for bound in (spec.low, spec.high))
        flat = spaces.Box(self._low, self._high, dtype=np.float32)
        self.observation: spaces.Box | spaces.Dict = flat if kind == "flat" else self._dict()

    def _dict(self) -> spaces.Dict:
        lengths = {stop - start for finger in self.parts for name, _, start, stop in finger if name == "forces"}
        if len(lengths) > 1:
            raise ValueError('observation = "dict": expected fingers with the same number of elements; use "flat"')
        joints = {stop - start for finger in self.parts for name, _, start, stop in finger if name == "joint_angles"}
        if len(joints) > 1:
            raise ValueError('observation = "dict": expected fingers with the same number of joints; use "flat"')
        low, high = self._parts(self._low), self._parts(self._high)
        return spaces.Dict({name: spaces.Box(low[name], high[name], dtype=np.float32) for name in low})

    def _shape(self, name: str, length: int) -> tuple[int, ...]:
        if name == "forces":
            return (self.fingers, length // 3, 3)
        is_vector = length > 1 or name in ("joint_angles", "joint_velocities")
        return (self.fingers, length) if is_vector else (self.fingers,)

    def observe(self, flat: NDArray[np.float32]) -> Observation:
        """Converts flat observations [..., L] to the kind of this space: unchanged, or split by name [..., F, ...]."""
        return flat if self.kind == "flat" else self._parts(flat)

    def _parts(self, flat: NDArray[np.float32]) -> dict[str, NDArray[np.float32]]:
        leading = flat.shape[:-1]
        of_fingers = flat.reshape(*leading, self.fingers, -1)
        return {
            name: np.ascontiguousarray(of_fingers[..., start:stop]).reshape(*leading, *self._shape(name, stop - start))
            for name, _, start, stop in self.parts[0]
        }

    def info(self, numbers: NDArray[np.float64]) -> dict[str, float]:
        """Returns the info of one step by name."""
        return dict(zip(self.info_names, numbers.tolist(), strict=True))


def expressions(vary: Mapping[str, str] | None) -> list[str]:
    """Converts ``{"friction": "uniform(0.3,1.2)"}`` into arguments of the program's ``--vary`` option."""
    return [f"{name}={distribution}" for name, distribution in (vary or {}).items()]
