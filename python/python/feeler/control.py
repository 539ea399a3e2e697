"""The control loop of a simulated rig, step by step, with custom tasks and control laws.

A task plans where each finger should go. A law determines how a finger follows the plan without losing or crushing the
object. Limits apply to the result and cannot be bypassed.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Literal, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from feeler import _core
from feeler._core import FingerSense, HandSense, Plan
from feeler._settings import Value, as_settings
from feeler.runs import Run
from feeler.sensing import PathLike

__all__ = ["FingerSense", "HandSense", "Law", "Phase", "Plan", "Session", "Step", "Task"]

Phase = Literal["SEARCH", "MOVE", "RELEASE", "RETURN", "DONE", "STOPPED"]


class Task:
    """Base class of tasks: a state machine that plans the motion of a hand.

    In every control step, :meth:`advance` is called first, then :meth:`plan` for each finger. An exception in either stops
    the hand and ends the session.
    """

    phase: Phase = "SEARCH"
    """Current phase; ``"DONE"`` ends the run."""
    stroke: int = 1
    """Number of the current cycle of touching and releasing, from 1."""
    outcome: str | None = None
    """Outcome of the task in a few words, or ``None`` while it is unknown."""
    failed: bool = False
    """``True`` if the outcome is a failure."""

    @property
    def findings(self) -> Mapping[str, float]:
        """Quantities that the task has measured so far, by name, in SI units."""
        return {}

    def advance(self, hand: HandSense) -> None:
        """Updates the task with the readings of the fingers, and starts the next phase when due."""

    def plan(self, finger: int, hand: HandSense) -> Plan:
        """Returns the planned motion of finger ``finger``."""
        raise NotImplementedError


class Law(Protocol):
    """A control law, which determines how a finger follows the plan. A law with state needs one instance per finger."""

    def velocity(self, plan: Plan, finger: FingerSense) -> ArrayLike:
        """Returns the velocity of the fingertip until the next control step [3], m/s, in W."""
        ...


class Step:
    """One control step, before the hand moves."""

    __slots__ = ("_velocity", "fingers", "plans", "time")

    def __init__(self, hand: HandSense, plans: Sequence[Plan]) -> None:
        self.time: float = hand.time
        """Time, s."""
        self.fingers: Sequence[FingerSense] = hand.fingers
        """Readings of each finger."""
        self.plans: Sequence[Plan] = plans
        """The task's plan for each finger."""
        self._velocity: NDArray[np.float64] | None = None

    def move(self, velocity: ArrayLike) -> None:
        """Requests fingertip velocities ``velocity`` [F, 3], m/s, in W, instead of the law's. The limits apply.

        A velocity that is not finite stops the hand.

        Raises
        ------
        ValueError
            If ``velocity`` has another shape.
        """
        array = np.ascontiguousarray(velocity, dtype=np.float64)
        if array.shape != (len(self.fingers), 3):
            raise ValueError(f"velocity: expected float64 [{len(self.fingers)}, 3], got {array.dtype} {list(array.shape)}")
        self._velocity = array

    def __repr__(self) -> str:
        return f"Step(time={self.time:.3f}, {list(self.fingers)})"


class Session:
    """A run of an experiment, one control step at a time.

    Iterating over the session runs it to the end::

        session = feeler.Session("cap-closing", sensing="direct")
        for step in session:
            print(step.time, step.fingers[0].grasp_force)

    The experiment's law moves the hand, unless :meth:`Step.move` is called in the body of the loop.
    """

    def __init__(
        self,
        experiment: PathLike,
        *,
        seed: int | None = None,
        sensing: str | None = None,
        settings: Mapping[str, Value] | None = None,
        task: Task | None = None,
        homes: ArrayLike | None = None,
        law: Law | Sequence[Law] | None = None,
        out: PathLike | None = None,
    ) -> None:
        """Sets up the run.

        Parameters
        ----------
        experiment
            An experiment file, or the name of a built-in experiment.
        seed, sensing, settings
            As in :func:`feeler.run`.
        task
            Replaces the task of the experiment.
        homes
            Start positions of the fingers [F, 3], m in W; by default, those of the experiment.
        law
            Replaces the law of the experiment: one law for all fingers, or one per finger.
        out
            New folder for recording and report; by default, nothing is recorded.

        Raises
        ------
        ValueError, OSError
            If the experiment is invalid, or the folder cannot be created.
        """
        lines = as_settings(settings)
        if seed is not None:
            lines.append(f"seed={int(seed)}")
        if sensing is not None:
            lines.append(f"sensing={sensing}")
        places = None if homes is None else np.asarray(homes, dtype=np.float64).reshape(-1, 3).tolist()
        laws = None if law is None else list(law) if isinstance(law, Sequence) else [law]
        if laws == []:
            raise ValueError("law: expected one law, or one for each finger, got none")
        self._session = _core.Session(str(experiment), lines, out and Path(out), task, places, laws)
        self.run: Run | None = None
        """The recorded run once the session is closed; ``None`` before, or if nothing is recorded."""

    @property
    def period(self) -> float:
        """Control period, s."""
        return self._session.period

    @property
    def phase(self) -> str:
        """Phase of the task, or ``"STOPPED"``."""
        return self._session.stands()[0]

    @property
    def stroke(self) -> int:
        """Number of the current cycle of touching and releasing, from 1."""
        return self._session.stands()[1]

    @property
    def stop_reason(self) -> str | None:
        """Reason for which the hand was stopped, or ``None`` if it is not stopped."""
        return self._session.stands()[2]

    @property
    def findings(self) -> dict[str, float]:
        """Quantities that the task has measured so far, by name, in SI units."""
        return dict(self._session.findings()[0])

    @property
    def outcome(self) -> str | None:
        """Outcome of the task, or ``None`` while it is unknown."""
        return self._session.findings()[1]

    def stop(self, by: str = "the user") -> None:
        """Stops the hand; the simulation continues."""
        self._session.stop(by)

    def resume(self) -> None:
        """Resumes after a stop."""
        self._session.resume()

    def __iter__(self) -> Iterator[Step]:
        """Steps until the run is finished, then closes the recording. Leaving the loop early also closes it.

        Raises
        ------
        RuntimeError
            If the session was closed, or a sensor or the hand failed.
        """
        whole = False
        try:
            while (planned := self._session.plan()) is not None:
                step = Step(*planned)
                yield step
                self._session.act(step._velocity)
            whole = True
        finally:
            self.close(interrupted=not whole)

    def close(self, *, interrupted: bool = True) -> Run | None:
        """Closes the recording and writes its report. Does nothing if nothing is recorded or the recording is closed."""
        outcome = self._session.close(interrupted)
        if outcome is not None:
            self.run = Run(outcome.folder)
        return self.run
