"""Contacts of a fingertip with an object, from the forces on its elements."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from feeler import _core
from feeler._arrays import checked
from feeler.sensing import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Contacts:
    """Contact of one fingertip in each of N frames. Vectors are in the fingertip's frame T.

    Unknown values are NaN; without contact, all fields but ``touching`` are NaN.
    """

    touching: NDArray[np.int64]
    """Number of touching elements [N]."""
    centre: FloatArray
    """Centre of pressure [N, 3], m; on a dome, projected onto it."""
    centre_error: FloatArray
    """Standard error of the centre along each tangent [N], m."""
    normal: FloatArray
    """Outward normal of the fingertip [N, 3]."""
    force: FloatArray
    """Force on the fingertip by the object [N, 3], N."""
    force_error: FloatArray
    """Standard error of each component of the force [N], N."""
    torsion: FloatArray
    """Torque on the fingertip by the object about ``normal`` through ``centre`` [N], N·m."""
    torsion_error: FloatArray
    """Standard error of the torsion [N], N·m."""
    semi_axes: FloatArray
    """Semi-axes of the contact area [N, 2], m, the longer one first; NaN if the elements do not resolve them."""
    semi_axis_errors: FloatArray
    """Standard errors of the semi-axes [N, 2], m."""
    direction: FloatArray
    """Direction of the longer semi-axis [N, 3]; its sign has no meaning."""
    area_error: FloatArray
    """Standard error of the area [N], m²."""
    friction: FloatArray
    """Coefficient of friction [N]: as given, or the latest estimate."""
    sliding: FloatArray
    """Fraction of the elements pressed with three times ``touch`` or more that slide [N], 0 to 1."""

    @property
    def area(self) -> FloatArray:
        """Contact area [N], m²."""
        area: FloatArray = np.pi * self.semi_axes.prod(axis=1)
        return area


def contacts(
    force: FloatArray,
    tips: FloatArray,
    rotations: FloatArray,
    *,
    touch: float = 0.1,
    friction: float | None = None,
) -> Contacts:
    """Estimates the contact in N consecutive frames of a fingertip of E elements.

    Parameters
    ----------
    force
        Force on each element by the object in its frame E_i [N, E, 3], N; z is compression. NaN if unknown.
    tips
        Position of each element in T [E, 3], m, as :attr:`Fingertip.tips`.
    rotations
        Rotation from each element's frame E_i to T [E, 3, 3], as :attr:`Fingertip.rotations`.
    touch
        Compression above which an element touches, N. A third of it is assumed to be the standard error of a force.
    friction
        Coefficient of friction; ``None`` estimates it from a contact that begins to slide.

    Raises
    ------
    ValueError
        If an array has an unexpected shape, or a number is not positive.
    """
    force = _checked("force", force, ("N", "E", 3))
    elements = force.shape[1]
    tips = _checked("tips", tips, (elements, 3))
    rotations = _checked("rotations", rotations, (elements, 3, 3))
    for name, number in (("touch", touch), ("friction", friction)):
        if number is not None and not 0 < number < np.inf:
            raise ValueError(f"{name}: expected a number greater than 0, got {number}")
    arrays = _core.estimate_contacts(force, tips, rotations, touch, friction)
    return Contacts(**{**arrays, "touching": np.nan_to_num(arrays["touching"]).astype(np.int64)})


def _checked(name: str, array: FloatArray, shape: tuple[int | str, ...]) -> FloatArray:
    contiguous: FloatArray = checked(name, np.ascontiguousarray(array, dtype=np.float64), np.float64, shape)
    return contiguous
