"""The control loop of a simulated rig, step by step, with tasks and laws of one's own.

A task says where each finger should go; a law decides how a finger gets there without losing or crushing what it holds;
limits that neither can pass let through what the hand may do.
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
    """What a hand does: a small state machine, to be subclassed.

    In every control step :meth:`advance` comes first, then :meth:`plan` for each finger. What either raises stops the
    hand and ends the session.
    """

    phase: Phase = "SEARCH"
    """Where the task stands; ``"DONE"`` ends the run."""
    stroke: int = 1
    """How many times the fingers have begun to touch and release, from 1."""
    outcome: str | None = None
    """What came of the task, in a few words, once it can tell. Recordings know the built-in tasks' words."""
    failed: bool = False
    """Whether what came of the task is something else than it was for."""

    @property
    def findings(self) -> Mapping[str, float]:
        """What the task found out so far, SI units, by name."""
        return {}

    def advance(self, hand: HandSense) -> None:
        """Takes in what the fingers feel, and goes on to the next phase where it is time to."""

    def plan(self, finger: int, hand: HandSense) -> Plan:
        """What finger ``finger`` is to do."""
        raise NotImplementedError


class Law(Protocol):
    """How a finger does what the task wants. Each finger should have one of its own if it remembers anything."""

    def velocity(self, plan: Plan, finger: FingerSense) -> ArrayLike:
        """Velocity of the fingertip until the next control step [3], m/s, in W."""
        ...


class Step:
    """One control step, before the hand moves."""

    __slots__ = ("_velocity", "fingers", "plans", "time")

    def __init__(self, hand: HandSense, plans: Sequence[Plan]) -> None:
        self.time: float = hand.time
        """Time, s."""
        self.fingers: Sequence[FingerSense] = hand.fingers
        """What each finger feels."""
        self.plans: Sequence[Plan] = plans
        """What the task wants of each finger."""
        self._velocity: NDArray[np.float64] | None = None

    def move(self, velocity: ArrayLike) -> None:
        """Moves the fingertips at ``velocity`` [F, 3], m/s, in W, in place of the law, as far as the limits admit.

        Raises
        ------
        ValueError
            When it has another shape. A velocity that is not finite stops the hand.
        """
        array = np.ascontiguousarray(velocity, dtype=np.float64)
        if array.shape != (len(self.fingers), 3):
            raise ValueError(f"velocity: expected float64 [{len(self.fingers)}, 3], got {array.dtype} {list(array.shape)}")
        self._velocity = array

    def __repr__(self) -> str:
        return f"Step(time={self.time:.3f}, {list(self.fingers)})"


class Session:
    """A run of an experiment, a control step at a time.

    Iterating over it goes to the end::

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
            In place of the experiment's.
        homes
            Where the fingers start from [F, 3], m in W; the experiment's if left out.
        law
            In place of the experiment's: one for all fingers, or one for each.
        out
            A new folder for recording and report; nothing is recorded if left out.

        Raises
        ------
        ValueError, OSError
            When the experiment cannot be used, or the folder cannot be made.
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
        """The run in its folder, once the session is closed, if it was recorded."""

    @property
    def period(self) -> float:
        """Control period, s."""
        return self._session.period

    @property
    def phase(self) -> str:
        """Where the task stands."""
        return self._session.stands()[0]

    @property
    def stroke(self) -> int:
        """How many times the fingers have begun to touch and release, from 1."""
        return self._session.stands()[1]

    @property
    def stop_reason(self) -> str | None:
        """Why the hand was stopped, if it was."""
        return self._session.stands()[2]

    @property
    def findings(self) -> dict[str, float]:
        """What the task found out so far, SI units, by name."""
        return dict(self._session.findings()[0])

    @property
    def outcome(self) -> str | None:
        """What came of the task, once it can tell."""
        return self._session.findings()[1]

    def stop(self, by: str = "the user") -> None:
        """Stops the hand; the rig goes on."""
        self._session.stop(by)

    def resume(self) -> None:
        """Lets a hand that was stopped go on."""
        self._session.resume()

    def __iter__(self) -> Iterator[Step]:
        """Steps until the run is finished, then closes the recording. A loop that is left closes it, too.

        Raises
        ------
        RuntimeError
            When the session was closed, or a sensor or the hand failed.
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
        """Closes the recording, and makes its report; nothing where nothing is recorded or it is closed already."""
        outcome = self._session.close(interrupted)
        if outcome is not None:
            self.run = Run(outcome.folder)
        return self.run
