"""Recordings as columns, with one row per control step."""

from __future__ import annotations

import tomllib
import warnings
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from feeler import _core
from feeler._arrays import read_only
from feeler.sensing import BoolArray, FloatArray, PathLike

if TYPE_CHECKING:
    import pandas
    import polars

PHASES = ("SEARCH", "MOVE", "RELEASE", "RETURN", "DONE", "STOPPED")
"""Phases of a task, in the order of their numbers."""


class Recording:
    """Recording of a run with F fingers of E elements, at N control steps.

    The row of a step contains the latest message of each kind up to that step. Missing values are NaN, ``False`` or -1.
    Columns are read-only.
    """

    COLUMNS: ClassVar[dict[str, str]] = {
        "time": "time of the control step [N], s",
        "phase": "phase of the task [N]",
        "stroke": "number of the stroke [N], from 1",
        "force": "force on each feeler by the object, in E_i [N, F, E, 3], N; z is compression",
        "shear_rate": "rate of each element's shear force [N, F, E], N/s",
        "touch": "TOUCH [N, F]",
        "slip": "SLIP [N, F]",
        "over": "OVER [N, F]",
        "largest_element": "touching element of largest compression [N, F]; -1 for none",
        "grasp_force": "sum of the elements' compressions [N, F], N",
        "joint_position": "joint positions [N, F, J], rad or m",
        "joint_velocity": "joint velocities [N, F, J], rad/s or m/s",
        "joint_command": "commanded joint velocities [N, F, J], rad/s or m/s",
        "fingertip_command": "fingertip velocity requested by the law, in W [N, F, 3], m/s",
        "limited": "true if a limit changed the request [N, F]",
        "position": "centre of the dome, in W [N, F, 3], m",
        "orientation": "rotation from the fingertip's frame T to W, quaternion x, y, z, w [N, F, 4]",
        "true_slip": "longest slip distance of a feeler since the previous step [N, F], m (simulated worlds)",
        "torque": "torque sensor [N], N·m, positive when the cap is turned on",
        "cap_angle": "angle that the cap has turned since the start [N], rad, positive when it is turned on",
        "cap_torque": "torque of the thread on the cap [N], N·m (simulated worlds)",
        "object_position": "position of the carried object, in W [N, 3], m (simulated worlds)",
        "object_orientation": "orientation of the carried object, quaternion x, y, z, w [N, 4] (simulated worlds)",
    }
    """Description of each column, with shape and unit."""

    time: FloatArray
    stroke: NDArray[np.uint32]
    force: FloatArray
    shear_rate: FloatArray
    touch: BoolArray
    slip: BoolArray
    over: BoolArray
    largest_element: NDArray[np.int64]
    grasp_force: FloatArray
    joint_position: FloatArray
    joint_velocity: FloatArray
    joint_command: FloatArray
    fingertip_command: FloatArray
    limited: BoolArray
    position: FloatArray
    orientation: FloatArray
    true_slip: FloatArray
    torque: FloatArray
    cap_angle: FloatArray
    cap_torque: FloatArray
    object_position: FloatArray
    object_orientation: FloatArray

    def __init__(self, path: PathLike) -> None:
        """Reads the recording at ``path``, with a warning if it is incomplete; see :func:`read`."""
        self.path = Path(path)
        if self.path.is_dir():
            self.path /= "recording.mcap"
        self._recording = _core.Recording(self.path)
        if not self.complete:
            warnings.warn(f"{self.path}: incomplete recording: {self.problem}; read up to there", stacklevel=3)

    @cached_property
    def phase(self) -> NDArray[np.str_]:
        """Phase of the task [N], one of :data:`PHASES`."""
        return read_only(np.array(PHASES)[self._recording.columns["phase"]])

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name not in self.COLUMNS:
            raise AttributeError(f"a recording has no {name!r}; expected one of {', '.join(self.COLUMNS)}")
        return self._recording.columns[name]

    @cached_property
    def experiment(self) -> dict[str, Any]:
        """The experiment as run."""
        return tomllib.loads(self._recording.experiment)

    @property
    def digest(self) -> str:
        """SHA-256 of all messages, which is equal for runs of the same program, experiment and seed."""
        return self._recording.digest

    @property
    def complete(self) -> bool:
        """``True`` if the recording is complete."""
        return self._recording.complete

    @property
    def problem(self) -> str | None:
        """Description of the damage, or ``None`` if the recording is complete."""
        return self._recording.problem

    @property
    def state(self) -> str:
        """State in which the run ended: ``done``, ``given up`` or ``interrupted``."""
        return self._recording.end[0]

    @property
    def reason(self) -> str | None:
        """Reason why the run ended early, or ``None``."""
        return self._recording.end[1]

    def frames(self, finger: int = 0, start: int = 0, stop: int | None = None) -> tuple[NDArray[np.uint8], FloatArray]:
        """Reads the recorded frames of one finger.

        Parameters
        ----------
        finger
            Index of the finger, from 0.
        start, stop
            Range of frames, by default all. A frame takes 0.3 MB.

        Returns
        -------
        frames
            uint8 [N, H, W].
        times
            Times of the frames [N], s.

        Raises
        ------
        ValueError
            If the recording does not contain these frames.
        OSError
            If the file cannot be read.
        """
        count = self._recording.frame_count(finger)
        stop = count if stop is None else stop
        if not 0 <= start < stop <= count:
            raise ValueError(f"frames {start} to {stop} of finger {finger}: the recording has {count} frames")
        frames, times = self._recording.frames(finger, start, stop)
        return frames, times

    def __len__(self) -> int:
        return len(self.time)

    def to_dict(self) -> dict[str, NDArray[Any]]:
        """Returns a flat table of one-dimensional columns such as ``finger0.force.5.z``.

        Columns without any data are left out.
        """
        flat: dict[str, NDArray[Any]] = {}
        for name in self.COLUMNS:
            column = getattr(self, name)
            if column.dtype.kind == "f" and np.isnan(column).all():
                continue
            per_finger = "[N, F" in self.COLUMNS[name]
            for index in np.ndindex(column.shape[1:]):
                flat[_flat_name(name, index, column.shape[1:], per_finger)] = column[(slice(None), *index)]
        return flat

    def to_pandas(self) -> pandas.DataFrame:
        """Returns the flat table of :meth:`to_dict` as a pandas data frame.

        Raises
        ------
        ModuleNotFoundError
            If pandas is not installed.
        """
        import pandas

        return pandas.DataFrame(self.to_dict())

    def to_polars(self) -> polars.DataFrame:
        """Returns the flat table of :meth:`to_dict` as a Polars data frame.

        Raises
        ------
        ModuleNotFoundError
            If Polars is not installed.
        """
        import polars

        return polars.DataFrame(self.to_dict())

    def __repr__(self) -> str:
        until = f"{self.time[-1]:.2f} s" if len(self) else "nothing"
        whole = "" if self.complete else f", incomplete: {self.problem}"
        fingers, elements = self._recording.fingers, self._recording.elements
        return f"Recording({str(self.path)!r}, {until}, {fingers} fingers of {elements} elements, {self.state}{whole})"


def _flat_name(name: str, index: tuple[int, ...], shape: tuple[int, ...], per_finger: bool) -> str:
    parts: list[str] = []
    rest = list(zip(index, shape, strict=True))
    if per_finger:
        parts.append(f"finger{rest.pop(0)[0]}")
    parts.append(name)
    axes = "xyzw" if rest and rest[-1][1] in (3, 4) and not name.startswith("joint") else None
    for place, (number, _) in enumerate(rest):
        last = place == len(rest) - 1
        parts.append(axes[number] if axes and last else str(number))
    return ".".join(parts)


def read(path: PathLike) -> Recording:
    """Reads a recording, up to the first damaged part. ``path`` is the folder of a run or a file.

    The file may have been rewritten by other tools, compressed with Zstandard or LZ4.

    Raises
    ------
    OSError, ValueError
        If the recording is unreadable.
    """
    return Recording(path)
