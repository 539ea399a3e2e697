"""Total forces on a fingertip, with a calibration by ``feeler calibrate --wrench``."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from feeler import _core
from feeler._arrays import checked
from feeler.sensing import BoolArray, FloatArray, Layout, PathLike


@dataclass(frozen=True, slots=True, eq=False)
class Wrenches:
    """Total wrench on one fingertip in each of N frames, in the frame and with the sign of the calibration's measurements.

    Components that are not calibrated are NaN. All are NaN if more than a tenth of the elements are missing.
    """

    force: FloatArray
    """Force [N, 3], N."""
    torque: FloatArray
    """Torque [N, 3], N·m."""
    place: FloatArray
    """Place of contact [N, 2], m; NaN without a touch."""
    valid: BoolArray
    """``True`` if the frame resembles those of the calibration [N]. Otherwise the components are extrapolated, or NaN if more
    than a tenth of the elements are missing."""
    novelty: FloatArray
    """Distance from the calibration's frames [N]; valid up to 1, infinite if too many elements are missing."""

    def __len__(self) -> int:
        return len(self.valid)


class WrenchEstimator:
    """Estimates the total force, torque and place of contact on a fingertip with a camera or a taxel array.

    An instance may be used from several threads at once.
    """

    __slots__ = ("_core", "_made_of")

    def __init__(
        self,
        calibration: str,
        *,
        layout: Layout | None = None,
        experiment: str | None = None,
        finger: int | None = None,
    ) -> None:
        """Creates an estimator from the content of a calibration file; see :meth:`load`."""
        self._made_of = (calibration, layout, experiment, finger)
        core = None if layout is None else layout._layout
        self._core = _core.WrenchEstimator(calibration, core, experiment, finger)

    @classmethod
    def load(
        cls,
        path: PathLike,
        *,
        layout: Layout | PathLike | None = None,
        experiment: str | None = None,
        finger: int | None = None,
    ) -> WrenchEstimator:
        """Loads the estimator of the calibration file at ``path``.

        Parameters
        ----------
        path
            File written by ``feeler calibrate --wrench``.
        layout
            Positions of the elements, required with a camera unless they are those of an experiment.
        experiment
            Experiment that contains the fingertip: a file, or the name of a built-in experiment.
        finger
            Index of the finger in the experiment.

        Raises
        ------
        OSError, ValueError
            If a file cannot be read or is invalid, or the calibration was made for another sensor.
        """
        if layout is not None and not isinstance(layout, Layout):
            layout = Layout.load(layout)
        text = Path(path).read_text(encoding="utf-8")
        return cls(text, layout=layout, experiment=experiment, finger=finger)

    @property
    def element_count(self) -> int:
        """Number of sensing elements, E."""
        return self._core.element_count

    def estimate(self, frames: NDArray[np.uint8]) -> Wrenches:
        """Estimates the wrench in each image, independently of the others.

        Parameters
        ----------
        frames
            8-bit gray images: uint8 [N, H, W], or [H, W] for a single one.

        Raises
        ------
        ValueError
            If ``frames`` has another dtype or shape, or the calibration is of a taxel array.
        """
        frames = np.ascontiguousarray(frames)
        frames = frames[np.newaxis] if frames.ndim == 2 else frames
        width, height = self._core.picture_size or (-1, -1)
        shape = ("N", height, width) if width >= 0 else ("N", "H", "W")
        return _wrenches(self._core.estimate(checked("frames", frames, np.uint8, shape)))

    def estimate_taxels(self, readings: FloatArray, stamps: FloatArray) -> Wrenches:
        """Estimates the wrench for each row of a taxel array. The rows are one sequence that begins without load.

        Parameters
        ----------
        readings
            Readings along x, y and z of each taxel [N, E, 3], relative to those without load, in the order and unit (N or
            counts) of the calibration's layout; NaN if missing.
        stamps
            Times of the rows [N], s, for the memory of calibrations that model creep.

        Raises
        ------
        ValueError
            If an array has another shape, or the calibration is of a camera's sensor.
        """
        readings = np.ascontiguousarray(readings, dtype=np.float64)
        readings = checked("readings", readings, np.float64, ("N", self.element_count, 3))
        stamps = np.ascontiguousarray(stamps, dtype=np.float64)
        stamps = checked("stamps", stamps, np.float64, (len(readings),))
        return _wrenches(self._core.estimate_taxels(readings, stamps))

    def __reduce__(self) -> tuple[Callable[..., WrenchEstimator], tuple[object, ...]]:
        return _restored, self._made_of

    def __repr__(self) -> str:
        return f"WrenchEstimator({self.element_count} elements)"


def _restored(calibration: str, layout: Layout | None, experiment: str | None, finger: int | None) -> WrenchEstimator:
    return WrenchEstimator(calibration, layout=layout, experiment=experiment, finger=finger)


def _wrenches(arrays: tuple[FloatArray, BoolArray, FloatArray]) -> Wrenches:
    components, valid, novelty = arrays
    return Wrenches(components[:, :3], components[:, 3:6], components[:, 6:], valid, novelty)
