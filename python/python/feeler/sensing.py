"""Tactile sensing: computes forces from images of the inside of a fingertip."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from feeler import _core
from feeler._arrays import checked, describe, output

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
PathLike = str | os.PathLike[str]


@dataclass(frozen=True, slots=True)
class Thresholds:
    """Thresholds of the flags (paper, Fig. 4). The defaults are the reference experiment's.

    Parameters
    ----------
    touch_force
        F1: compression above which an element counts as touching, N.
    over_force
        F2: compression above which an element must not be pressed further, N.
    slip_threshold
        dr: shear rate above which an element counts as slipping, N/s.
    """

    touch_force: float = 0.1
    over_force: float = 0.505
    slip_threshold: float = 6.5


@dataclass(frozen=True, slots=True, eq=False)
class Felt:
    """Tactile readings of one fingertip of E elements in N frames. All arrays are C-contiguous.

    Forces are on the feeler by the object, in the element's frame ``E_i``: x and y are tangential, z is compression,
    positive when pressed.
    """

    force: FloatArray
    """Force on each element [N, E, 3], N; NaN if unknown."""
    valid: BoolArray
    """``True`` if ``force`` can be used [N, E]: the sub-region is neither dark nor saturated."""
    gray: FloatArray
    """Integrated gray value G of each element [N, E], grey levels times m² (px² without a dome)."""
    displacement: FloatArray
    """Displacement u of each element's centroid from its unloaded position [N, E, 2], m (px without a dome)."""
    shear_rate: FloatArray
    """Shear rate of each element [N, E], N/s; 0 in the first frame."""
    touch: BoolArray
    """TOUCH [N]: the compression of an element is above F1, or SLIP is raised."""
    slip: BoolArray
    """SLIP [N]: the shear rate of an element is above dr."""
    over: BoolArray
    """OVER [N]: the compression of an element is above F2."""
    grasp_force: FloatArray
    """Sum of the elements' compressions [N], N."""

    @classmethod
    def empty(cls, frames: int, elements: int) -> Felt:
        """Allocates arrays for ``frames`` frames of ``elements`` elements, to be filled by :meth:`Fingertip.sense`."""
        per_element, per_frame = (frames, elements), (frames,)
        return cls(
            force=np.empty((*per_element, 3)),
            valid=np.empty(per_element, dtype=np.bool_),
            gray=np.empty(per_element),
            displacement=np.empty((*per_element, 2)),
            shear_rate=np.empty(per_element),
            touch=np.empty(per_frame, dtype=np.bool_),
            slip=np.empty(per_frame, dtype=np.bool_),
            over=np.empty(per_frame, dtype=np.bool_),
            grasp_force=np.empty(per_frame),
        )

    def __len__(self) -> int:
        return len(self.force)

    def __repr__(self) -> str:
        frames, elements = self.gray.shape
        valid = np.count_nonzero(self.valid)
        return (
            f"Felt({frames} frames, {elements} elements, {valid} of {self.valid.size} forces valid, "
            f"TOUCH in {np.count_nonzero(self.touch)}, SLIP in {np.count_nonzero(self.slip)}, "
            f"OVER in {np.count_nonzero(self.over)})"
        )

    def _check(self, frames: int, elements: int) -> None:
        expected = {
            "force": (np.float64, (frames, elements, 3)),
            "valid": (np.bool_, (frames, elements)),
            "gray": (np.float64, (frames, elements)),
            "displacement": (np.float64, (frames, elements, 2)),
            "shear_rate": (np.float64, (frames, elements)),
            "touch": (np.bool_, (frames,)),
            "slip": (np.bool_, (frames,)),
            "over": (np.bool_, (frames,)),
            "grasp_force": (np.float64, (frames,)),
        }
        for name, (dtype, shape) in expected.items():
            output(f"out.{name}", getattr(self, name), dtype, shape)


@dataclass(frozen=True, slots=True, eq=False)
class Layout:
    """Positions of a fingertip's sensing elements in its images, found by :func:`locate`."""

    _layout: _core.Layout = field(repr=False)

    @classmethod
    def load(cls, path: PathLike) -> Layout:
        """Reads a file that :meth:`save` or ``feeler locate`` wrote.

        Raises
        ------
        OSError, ValueError
            If the file cannot be read or is not a layout.
        """
        return cls(_core.Layout.parse(Path(path).read_text(encoding="utf-8")))

    def save(self, path: PathLike) -> None:
        """Writes the layout (TOML)."""
        _write_new(path, self._layout.to_toml())

    @property
    def polarity(self) -> str:
        """Polarity of the elements: ``"bright"`` or ``"dark"``."""
        return self._layout.polarity

    @property
    def centres(self) -> FloatArray:
        """Column and row of each element's centre [E, 2], px."""
        centres: FloatArray = self._layout.centres()
        return centres

    @property
    def radii(self) -> FloatArray:
        """Radius of each element's sub-region [E], px."""
        radii: FloatArray = self._layout.radii()
        return radii

    @property
    def warnings(self) -> list[str]:
        """Possible problems in the images, for a person to check."""
        return self._layout.warnings

    def __len__(self) -> int:
        return self._layout.element_count

    def __reduce__(self) -> tuple[Callable[..., Layout], tuple[str, list[str]]]:
        return _restored_layout, (self._layout.to_toml(), self.warnings)

    def __repr__(self) -> str:
        width, height = self._layout.picture_size
        return f"Layout({len(self)} elements in {width}x{height} px)"


@dataclass(frozen=True, slots=True, eq=False)
class Calibration:
    """Computes the force on each element from its integrated gray value and displacement."""

    _calibration: _core.Calibration = field(repr=False)

    @classmethod
    def load(cls, path: PathLike) -> Calibration:
        """Reads a file that :meth:`save` or ``feeler calibrate`` wrote.

        Raises
        ------
        OSError, ValueError
            If the file cannot be read or is not a calibration of this version.
        """
        return cls(_core.Calibration.parse(Path(path).read_text(encoding="utf-8")))

    def save(self, path: PathLike) -> None:
        """Writes the calibration (TOML) to a new file; fails if the file exists."""
        _write_new(path, self._calibration.to_toml())

    @property
    def model(self) -> str:
        """``separable`` (the paper's) or ``coupled``."""
        return self._calibration.model

    @property
    def held_out_rms(self) -> FloatArray:
        """Root mean square error on held-out loads, along x, y, z of each element [E, 3], N."""
        return np.array(self._calibration.held_out_rms())

    def report(self) -> str:
        """Returns errors, repeatability, hysteresis and resolution per ring, as text."""
        return self._calibration.report()

    def __reduce__(self) -> tuple[Callable[..., Calibration], tuple[str]]:
        return _restored_calibration, (self._calibration.to_toml(),)

    def __repr__(self) -> str:
        return f"Calibration({self.model}, {self._calibration.element_count} elements)\n{self.report()}"


class Fingertip:
    """Computes forces and flags from the images of one fingertip.

    An instance may be used from several threads at once, unless it corrects drift, which depends on the order of frames.
    Copies by ``pickle`` or ``copy`` restart the drift correction.
    """

    __slots__ = ("_made_of", "_sensor", "thresholds")

    def __init__(
        self,
        calibration: Calibration | None = None,
        *,
        layout: Layout | None = None,
        experiment: str | None = None,
        finger: int | None = None,
        drift_correction: bool = False,
        max_saturated: float | None = None,
        thresholds: Thresholds | None = None,
    ) -> None:
        """Creates a fingertip from its calibration, or without forces from its layout or an experiment.

        Parameters
        ----------
        calibration
            Calibration, required for forces. A calibration of a located layout also needs that ``layout``.
        layout
            Positions of the elements, found by :func:`locate`.
        experiment
            Experiment that contains the fingertip: a file, or the name of a built-in experiment.
        finger
            Index of the finger in the experiment; by default, the fingertip that the experiment defines for all fingers.
        drift_correction
            Corrects for a lamp whose brightness changes from frame to frame.
        max_saturated
            Maximum share (0 to 1) of a sub-region's pixels that may be saturated (for dark markers: black) before its force
            is invalid; by default 0.01, for dark markers 0.9, in images of two grey levels 0.98.
        thresholds
            Thresholds of the flags.

        Raises
        ------
        ValueError
            If the arguments do not match each other.
        """
        if calibration is None and layout is None and experiment is None:
            raise ValueError("expected a calibration, a layout or an experiment")
        if drift_correction and calibration is None:
            raise ValueError("drift_correction: expected a calibration, which defines the state without drift")
        self._made_of = (calibration, layout, experiment, finger, drift_correction, max_saturated)
        self._sensor = _core.Sensor(
            None if calibration is None else calibration._calibration,
            None if layout is None else layout._layout,
            experiment,
            finger,
            drift_correction,
            max_saturated,
        )
        self.thresholds = thresholds or Thresholds()

    @classmethod
    def load(cls, path: PathLike, *, layout: Layout | PathLike | None = None, **options: Any) -> Fingertip:
        """Loads the fingertip of the calibration file at ``path``; ``options`` are those of the class.

        Raises
        ------
        OSError, ValueError
            If a file cannot be read or is invalid.
        """
        if layout is not None and not isinstance(layout, Layout):
            layout = Layout.load(layout)
        return cls(Calibration.load(path), layout=layout, **options)

    @property
    def element_count(self) -> int:
        """Number of sensing elements, E."""
        return self._sensor.element_count

    @property
    def picture_shape(self) -> tuple[int, int]:
        """Rows and columns of the images, px."""
        width, height = self._sensor.picture_size
        return height, width

    @property
    def is_calibrated(self) -> bool:
        """``True`` if a calibration provides forces."""
        return self._sensor.is_calibrated

    @property
    def centres(self) -> FloatArray:
        """Column and row of each element's centre in the image [E, 2], px."""
        centres: FloatArray = self._sensor.centres()
        return centres

    @property
    def tips(self) -> FloatArray:
        """Tip of each unloaded feeler in the fingertip's frame T [E, 3], m; x is along the dome's axis, outward.

        Raises
        ------
        ValueError
            If the elements were located without a ``dome``.
        """
        return _on_dome(self._sensor.tips())

    @property
    def rotations(self) -> FloatArray:
        """Rotation from each element's frame E_i to T [E, 3, 3]; the columns are x, y and z, the outward normal.

        Raises
        ------
        ValueError
            If the elements were located without a ``dome``.
        """
        return _on_dome(self._sensor.rotations())

    def force_on_fingertip(self, force: FloatArray) -> FloatArray:
        """Converts sensed forces (in E_i, z is compression [..., E, 3], N) to force vectors in T [..., E, 3], N.

        The vectors are forces on the fingertip by the object; their sum over elements is the resultant.

        Raises
        ------
        ValueError
            If ``force`` does not have E elements, or the elements were located without a ``dome``.
        """
        force = np.asarray(force, dtype=np.float64)
        if force.shape[-2:] != (self.element_count, 3):
            raise ValueError(f"force: expected {describe(np.float64, ('...', self.element_count, 3))}, got {list(force.shape)}")
        # Compression acts along the inward normal.
        vectors: FloatArray = np.einsum("eij,...ej->...ei", self.rotations, force * (1.0, 1.0, -1.0))
        return vectors

    def with_reference(self, frames: NDArray[np.uint8]) -> Fingertip:
        """Returns a copy whose displacements are relative to the mean centroids in the unloaded ``frames`` [N, H, W].

        Forces remain relative to the calibration's reference.
        """
        return self._with(self._sensor.with_reference(self._frames(frames)))

    def _with(self, sensor: _core.Sensor) -> Fingertip:
        changed = object.__new__(Fingertip)
        changed._made_of = self._made_of
        changed._sensor = sensor
        changed.thresholds = self.thresholds
        return changed

    def __reduce__(self) -> tuple[Callable[..., Fingertip], tuple[Any, ...]]:
        return _restored_fingertip, (self._made_of, self.thresholds, self._sensor.reference())

    def sense(
        self,
        frames: NDArray[np.uint8],
        *,
        rate: float = 100.0,
        stamps: FloatArray | None = None,
        threads: int = 1,
        out: Felt | None = None,
    ) -> Felt:
        """Computes forces and flags from ``frames``, in the order in which they were taken.

        Parameters
        ----------
        frames
            8-bit gray images: uint8 [N, H, W], or [H, W] for a single one. They are read in place and must not be modified
            during the call.
        rate
            Frames per second, for shear rates.
        stamps
            Increasing times of the frames [N], s, instead of ``rate``.
        threads
            Number of threads that share the frames; always 1 with drift correction.
        out
            Arrays to write to instead of new ones; see :meth:`Felt.empty`.

        Returns
        -------
        Felt
            ``out``, if it was given.

        Raises
        ------
        ValueError
            If an array has an unexpected dtype, shape or memory order; the message names the array.
        """
        frames = self._frames(frames)
        count = len(frames)
        if threads < 1:
            raise ValueError(f"threads: expected 1 or more, got {threads}")
        stamps = _stamps(count, rate, stamps)
        if out is None:
            out = Felt.empty(count, self.element_count)
        else:
            out._check(count, self.element_count)
        self._sensor.sense(
            frames,
            out.force,
            out.valid,
            out.gray,
            out.displacement,
            threads,
        )
        _core.raise_flags(
            out.force,
            stamps,
            (self.thresholds.touch_force, self.thresholds.over_force, self.thresholds.slip_threshold),
            (out.shear_rate, out.touch, out.slip, out.over, out.grasp_force),
        )
        return out

    def _frames(self, frames: NDArray[np.uint8]) -> NDArray[np.uint8]:
        height, width = self.picture_shape
        if isinstance(frames, np.ndarray) and frames.ndim == 2:
            frames = frames[np.newaxis]
        return checked("frames", frames, np.uint8, ("N", height, width))

    def __repr__(self) -> str:
        height, width = self.picture_shape
        forces = "calibrated" if self.is_calibrated else "without forces"
        return f"Fingertip({self.element_count} elements in {width}x{height} px, {forces})"


def _restored_layout(text: str, warnings: list[str]) -> Layout:
    return Layout(_core.Layout.parse(text, warnings))


def _restored_calibration(text: str) -> Calibration:
    return Calibration(_core.Calibration.parse(text))


def _restored_fingertip(
    made_of: tuple[Any, ...], thresholds: Thresholds, reference: list[tuple[float, float] | None] | None
) -> Fingertip:
    calibration, layout, experiment, finger, drift_correction, max_saturated = made_of
    fingertip = Fingertip(
        calibration,
        layout=layout,
        experiment=experiment,
        finger=finger,
        drift_correction=drift_correction,
        max_saturated=max_saturated,
        thresholds=thresholds,
    )
    return fingertip if reference is None else fingertip._with(fingertip._sensor.with_reference_at(reference))


def _on_dome(places: FloatArray | None) -> FloatArray:
    if places is None:
        raise ValueError('the elements were located without a dome; expected a layout from locate(frames, dome="EXPERIMENT")')
    return places


def _stamps(count: int, rate: float, stamps: FloatArray | None) -> FloatArray:
    """Returns the time of each frame, s."""
    if stamps is not None:
        stamps = checked("stamps", stamps, np.float64, (count,))
        if not (np.all(np.isfinite(stamps)) and np.all(np.diff(stamps) > 0.0)):
            raise ValueError("stamps: expected rising times in s")
        return stamps
    if not (np.isfinite(rate) and rate > 0.0):
        raise ValueError(f"rate: expected frames per second above 0, got {rate}")
    return np.arange(count) / rate


def locate(
    frames: NDArray[np.uint8],
    *,
    polarity: Literal["bright", "dark"] | None = None,
    spot_diameter: float | None = None,
    element_diameter: float | None = None,
    region_radius: float = 0.5,
    dome: str | None = None,
) -> Layout:
    """Locates the sensing elements in the mean of images of the untouched sensor.

    Parameters
    ----------
    frames
        uint8 [N, H, W], or [H, W] for a single image.
    polarity
        Bright elements on a dark background, or dark on bright; by default, the polarity with the better pattern.
    spot_diameter
        Diameter of a spot, px; by default estimated from the image.
    element_diameter
        Diameter of an element, px; spots within it form one element. By default, groups with equal numbers of spots form an
        element, if there are any such groups.
    region_radius
        Radius of a sub-region relative to the distance to the nearest element.
    dome
        Experiment (a file, or the name of a built-in one) that defines the dome and camera. Moments are then in m.

    Raises
    ------
    ValueError
        If no elements are found.
    """
    if isinstance(frames, np.ndarray) and frames.ndim == 2:
        frames = frames[np.newaxis]
    frames = checked("frames", frames, np.uint8, ("N", "H", "W"))
    return Layout(_core.locate(frames, polarity, spot_diameter, element_diameter, region_radius, dome))


def calibrate(
    loads: PathLike | None = None,
    *,
    frames: NDArray[np.uint8] | None = None,
    forces: FloatArray | None = None,
    layout: Layout | None = None,
    experiment: str = "cap-closing",
    finger: int | None = None,
    model: Literal["separable", "coupled", "auto"] = "auto",
    full_scale: Sequence[float] | None = None,
) -> Calibration:
    """Fits a calibration to images under known loads.

    Parameters
    ----------
    loads
        Table with the columns picture (relative to the file), element, f_x, f_y, f_z (N): the force on the finger, f_z
        positive when pressed.
    frames, forces
        Instead of a file: uint8 [N, H, W], and the force on each element in each frame [N, E, 3], N; zero for an unloaded
        element, NaN if unknown.
    layout
        Positions of the elements; by default, those of the fingertip of ``finger`` in ``experiment``.
    model
        ``separable`` is the paper's model, ``coupled`` includes the tilt of the column, and ``auto`` selects the one that
        predicts held-out loads better.
    full_scale
        Compression and shear to which errors are relative, N; by default, the largest loads.

    Raises
    ------
    OSError, ValueError
        If a file cannot be read, the loads do not determine a calibration, or the images contradict them (signs, axes or
        number of elements), or loads are below 0.01 N or above 20 N.
    """
    normal, shear = full_scale if full_scale is not None else (None, None)
    how = {
        "layout": None if layout is None else layout._layout,
        "experiment": experiment,
        "finger": finger,
        "model": model,
        "full_scale_normal": normal,
        "full_scale_shear": shear,
    }
    if loads is not None:
        if frames is not None or forces is not None:
            raise ValueError("expected a file of loads, or frames and forces, not both")
        return Calibration(_core.calibrate_file(Path(loads), how))
    if frames is None or forces is None:
        raise ValueError("expected a file of loads, or frames and forces")
    frames = checked("frames", frames, np.uint8, ("N", "H", "W"))
    forces = checked("forces", forces, np.float64, (len(frames), "E", 3))
    return Calibration(_core.calibrate_frames(frames, forces, how))


def simulate_loads(
    experiment: str = "cap-closing", *, finger: int | None = None, loads: int = 400, seed: int = 1
) -> tuple[NDArray[np.uint8], FloatArray]:
    """Renders images of a simulated fingertip under known loads, as on a calibration bench.

    Parameters
    ----------
    experiment, finger
        Experiment and index of the finger that define the fingertip.
    loads
        Number of combined loads of compression and shear. Sweeps, cycles and unloaded images are added.
    seed
        Random seed for the order of loads and the camera noise.

    Returns
    -------
    frames
        uint8 [N, H, W], 0.3 MB each.
    forces
        Force on each element in each image [N, E, 3], N.

    Raises
    ------
    ValueError
        If there is no such fingertip.
    """
    frames, forces = _core.simulate_loads(experiment, finger, loads, seed)
    return frames, forces


def _write_new(path: PathLike, text: str) -> None:
    with Path(path).open("x", encoding="utf-8") as file:
        file.write(text)
