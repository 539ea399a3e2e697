"""From pictures of a fingertip's inside to forces on its elements."""

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
        F1: an element pressed harder than this touches, N.
    over_force
        F2: an element pressed harder than this may not be pressed further, N.
    slip_threshold
        dr: an element whose shear force changes faster than this slips, N/s.
    """

    touch_force: float = 0.1
    over_force: float = 0.505
    slip_threshold: float = 6.5


@dataclass(frozen=True, slots=True, eq=False)
class Felt:
    """What one fingertip of E elements felt in N frames. All arrays are C-contiguous.

    Forces are on the feeler by the object, in the element's frame ``E_i``: x and y are tangential, z is compression,
    positive when pressed.
    """

    force: FloatArray
    """Force on each element [N, E, 3], N; not a number where there is none."""
    valid: BoolArray
    """Where ``force`` can be used [N, E]: the sub-region is neither dark nor saturated."""
    gray: FloatArray
    """Integrated gray value G of each element [N, E], grey levels times m² (px² without a dome)."""
    displacement: FloatArray
    """Displacement u of each element's centroid from its unloaded place [N, E, 2], m (px without a dome)."""
    shear_rate: FloatArray
    """Rate of each element's shear force [N, E], N/s; 0 in the first frame."""
    touch: BoolArray
    """TOUCH [N]: an element is pressed harder than F1, or slips."""
    slip: BoolArray
    """SLIP [N]: an element's shear force changes faster than dr."""
    over: BoolArray
    """OVER [N]: an element is pressed harder than F2."""
    grasp_force: FloatArray
    """Sum of the elements' compressions [N], N."""

    @classmethod
    def empty(cls, frames: int, elements: int) -> Felt:
        """Arrays for ``frames`` frames of ``elements`` elements, to be filled by :meth:`Fingertip.sense`."""
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
    """Where the sensing elements of a fingertip are in its pictures, as :func:`locate` finds them."""

    _layout: _core.Layout = field(repr=False)

    @classmethod
    def load(cls, path: PathLike) -> Layout:
        """Reads a file that :meth:`save` or ``feeler locate`` wrote.

        Raises
        ------
        OSError, ValueError
            When it cannot be read, or is no layout.
        """
        return cls(_core.Layout.parse(Path(path).read_text(encoding="utf-8")))

    def save(self, path: PathLike) -> None:
        """Writes the layout (TOML)."""
        _write_new(path, self._layout.to_toml())

    @property
    def polarity(self) -> str:
        """Whether the elements are bright ("bright") or dark ("dark")."""
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
        """What a person should look at in the pictures."""
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
    """From an element's integrated gray value and displacement to the force on it."""

    _calibration: _core.Calibration = field(repr=False)

    @classmethod
    def load(cls, path: PathLike) -> Calibration:
        """Reads a file that :meth:`save` or ``feeler calibrate`` wrote.

        Raises
        ------
        OSError, ValueError
            When it cannot be read, or is no calibration of this version.
        """
        return cls(_core.Calibration.parse(Path(path).read_text(encoding="utf-8")))

    def save(self, path: PathLike) -> None:
        """Writes the calibration (TOML). There must be no such file yet."""
        _write_new(path, self._calibration.to_toml())

    @property
    def model(self) -> str:
        """``separable`` (the paper's) or ``coupled``."""
        return self._calibration.model

    @property
    def held_out_rms(self) -> FloatArray:
        """Root mean square error on loads that the fit has not seen, along x, y, z of each element [E, 3], N."""
        return np.array(self._calibration.held_out_rms())

    def report(self) -> str:
        """Errors, repeatability, hysteresis and resolution, ring by ring."""
        return self._calibration.report()

    def __reduce__(self) -> tuple[Callable[..., Calibration], tuple[str]]:
        return _restored_calibration, (self._calibration.to_toml(),)

    def __repr__(self) -> str:
        return f"Calibration({self.model}, {self._calibration.element_count} elements)\n{self.report()}"


class Fingertip:
    """Senses the pictures of one fingertip.

    It may be used from several threads at once, unless drift is corrected, which goes by the order of frames. A copy, as
    ``pickle`` and ``copy`` make it, begins to correct drift anew.
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
        """A fingertip by its calibration, or without forces by its layout or the experiment that has it.

        Parameters
        ----------
        calibration
            Gives forces. One that was made for a located layout needs that ``layout``, too.
        layout
            Where the elements are, as :func:`locate` found them.
        experiment
            The experiment whose fingertip it is: a file, or the name of a built-in one.
        finger
            The finger of the experiment; without it, what fingers have without a fingertip of their own.
        drift_correction
            Correct for a lamp that dims or brightens, from frame to frame.
        max_saturated
            Part (0 to 1) of a sub-region's pixels that may be saturated (of dark markers: black) before its force is left out;
            by default 0.01, of dark markers 0.9, in pictures of two grey levels 0.98.
        thresholds
            Of the flags.

        Raises
        ------
        ValueError
            When these do not go together.
        """
        if calibration is None and layout is None and experiment is None:
            raise ValueError("expected a calibration, a layout or an experiment")
        if drift_correction and calibration is None:
            raise ValueError("drift_correction: expected a calibration, which says what is without drift")
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
        """The fingertip of the calibration in the file at ``path``; ``options`` as those of the class.

        Raises
        ------
        OSError, ValueError
            When a file cannot be read, or is not what it should be.
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
        """Rows and columns of the pictures, px."""
        width, height = self._sensor.picture_size
        return height, width

    @property
    def is_calibrated(self) -> bool:
        """Whether there are forces."""
        return self._sensor.is_calibrated

    @property
    def centres(self) -> FloatArray:
        """Column and row at which the camera sees each element's centre [E, 2], px."""
        centres: FloatArray = self._sensor.centres()
        return centres

    @property
    def tips(self) -> FloatArray:
        """Tip of each unloaded feeler, in the fingertip's frame T [E, 3], m: x is along the dome's axis, outward.

        Raises
        ------
        ValueError
            When the elements were located without a ``dome``.
        """
        return _on_dome(self._sensor.tips())

    @property
    def rotations(self) -> FloatArray:
        """From each element's frame E_i to T [E, 3, 3]: columns are its x, y, and z, the outward normal.

        Raises
        ------
        ValueError
            When the elements were located without a ``dome``.
        """
        return _on_dome(self._sensor.rotations())

    def force_on_fingertip(self, force: FloatArray) -> FloatArray:
        """Forces as they are sensed (in E_i, z is compression [..., E, 3], N) as vectors in T [..., E, 3], N.

        They are on the fingertip by what it touches, so that their sum over elements is the resultant.

        Raises
        ------
        ValueError
            When the forces are not of E elements, or the elements were located without a ``dome``.
        """
        force = np.asarray(force, dtype=np.float64)
        if force.shape[-2:] != (self.element_count, 3):
            raise ValueError(f"force: expected {describe(np.float64, ('...', self.element_count, 3))}, got {list(force.shape)}")
        # Compression is along the inward normal.
        vectors: FloatArray = np.einsum("eij,...ej->...ei", self.rotations, force * (1.0, 1.0, -1.0))
        return vectors

    def with_reference(self, frames: NDArray[np.uint8]) -> Fingertip:
        """The same fingertip, whose displacements count from the mean centroids in ``frames`` [N, H, W] without load.

        Forces count from the calibration's own reference.
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
        """Senses ``frames``, in the order in which they were taken.

        Parameters
        ----------
        frames
            Grey 8-bit pictures: uint8 [N, H, W], or [H, W] for one. They are read in place and must not be changed
            meanwhile.
        rate
            Frames per second, for shear rates.
        stamps
            Times of the frames [N], s, rising, instead of ``rate``.
        threads
            How many threads share the frames; 1 where drift is corrected.
        out
            Written to instead of new arrays (:meth:`Felt.empty`).

        Returns
        -------
        Felt
            ``out``, if it was given.

        Raises
        ------
        ValueError
            Names the array that has another dtype, shape or order than expected.
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
        raise ValueError('the elements were located without a dome; expected a layout of locate(frames, dome="EXPERIMENT")')
    return places


def _stamps(count: int, rate: float, stamps: FloatArray | None) -> FloatArray:
    """Time of each frame, s."""
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
    """Finds the sensing elements in the mean of pictures of the untouched sensor.

    Parameters
    ----------
    frames
        uint8 [N, H, W], or [H, W] for one.
    polarity
        Whether the elements are bright on dark or dark on bright; whichever makes the better pattern if left out.
    spot_diameter
        Diameter of a spot, px; estimated from the picture if left out.
    element_diameter
        Diameter of an element, px: spots within it are one element. Without it, groups of equal numbers of spots are,
        if there are any.
    region_radius
        Radius of a sub-region relative to the distance to the nearest element.
    dome
        The experiment (a file, or a built-in one) whose dome and camera these are: moments are then in m.

    Raises
    ------
    ValueError
        When there is nothing that looks like an element.
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
    """Fits a calibration to pictures under known loads.

    Parameters
    ----------
    loads
        Table with the columns picture (relative to the file), element, f_x, f_y, f_z (N): the force on the finger, f_z
        positive when pressed.
    frames, forces
        Instead of a file: uint8 [N, H, W], and the force on each element in each frame [N, E, 3], N; zero where it is
        not loaded, not a number where nothing is known of it.
    layout
        Where the elements are; without it, the fingertip is that of ``finger`` of ``experiment``.
    model
        The paper's (``separable``), one that includes the tilt of the column (``coupled``), or whichever predicts
        held-out loads better.
    full_scale
        Compression and shear that shares of full scale refer to, N; without it, the largest loads.

    Raises
    ------
    OSError, ValueError
        When a file cannot be read, the loads do not determine a calibration, or the pictures contradict them: signs, axes,
        numbers of elements, and loads below 0.01 N or above 20 N.
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
    """Pictures of a simulated fingertip under known loads, as a laboratory would take them.

    Parameters
    ----------
    experiment, finger
        Whose fingertip it is.
    loads
        Combined loads of compression and shear; sweeps, cycles and pictures without load come in addition.
    seed
        Of the loads' order and of the camera's noise.

    Returns
    -------
    frames
        uint8 [N, H, W], 0.3 MB each.
    forces
        Force on each element in each picture [N, E, 3], N.

    Raises
    ------
    ValueError
        When there is no such fingertip.
    """
    frames, forces = _core.simulate_loads(experiment, finger, loads, seed)
    return frames, forces


def _write_new(path: PathLike, text: str) -> None:
    with Path(path).open("x", encoding="utf-8") as file:
        file.write(text)
