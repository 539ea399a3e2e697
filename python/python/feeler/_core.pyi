"""
Rust side of the package `feeler`.
"""

from _typeshed import Incomplete, SupportsGetItem, SupportsLenAndGetItem
from os import PathLike
from pathlib import Path
from typing import Any, Final, SupportsFloat, SupportsIndex, final

__all__ = ["__version__", "Calibration", "EnvironmentSpec", "FingerSense", "HandSense", "Layout", "ManyEnvironments", "Plan", "Recording", "RunOutcome", "Sensor", "Session", "SingleEnvironment", "Store", "Trials", "calibrate_file", "calibrate_frames", "locate", "raise_flags", "read_table", "report", "run", "simulate_loads"]

__version__: Final[str]

@final
class Calibration:
    """
    From moments to forces, for one fingertip.
    """
    @property
    def element_count(self, /) -> int: ...
    def held_out_rms(self, /) -> list[list[float]]:
        """
        Root mean square error on held-out loads along x, y, z of each element, N [E, 3].
        """
    @property
    def model(self, /) -> str: ...
    @staticmethod
    def parse(text: str) -> Calibration:
        """
        The calibration that `text` (TOML) says.
        """
    def report(self, /) -> str:
        """
        Its errors, as text.
        """
    def to_toml(self, /) -> str: ...

@final
class EnvironmentSpec:
    """
    What an environment's numbers mean.
    """
    @property
    def action_bounds(self, /) -> list[float]:
        """
        How large each number of an action can be before a limit changes it.
        """
    @property
    def high(self, /) -> list[float]: ...
    @property
    def info_names(self, /) -> list[str]:
        """
        What is told beside the reward, with units.
        """
    @property
    def low(self, /) -> list[float]:
        """
        Least and greatest of each number of an observation.
        """
    @property
    def max_steps(self, /) -> int:
        """
        Most control steps of an episode.
        """
    @property
    def parts(self, /) -> list[list[tuple[str, str, int, int]]]:
        """
        Of each finger, parts of its observation: name, unit, first number, and the one after the last.
        """
    @property
    def period(self, /) -> float:
        """
        Control period, s.
        """

@final
class FingerSense:
    """
    What one finger feels, and where.
    """
    def __repr__(self, /) -> str: ...
    @property
    def force(self, /) -> Incomplete:
        """
        Force on each feeler by the object, in `E_i` [E, 3], N; z is compression, positive when pressed.
        """
    @property
    def grasp_force(self, /) -> float:
        """
        Sum of the elements' compressions, N.
        """
    @property
    def joint_position(self, /) -> Incomplete:
        """
        Joint angles [3], rad.
        """
    @property
    def joint_velocity(self, /) -> Incomplete:
        """
        Joint velocities [3], rad/s.
        """
    @property
    def largest_element(self, /) -> int | None:
        """
        The touching element of largest compression; none where none touches.
        """
    @property
    def normal(self, /) -> Incomplete:
        """
        The dome's outward normal at each element [E, 3], unit vectors in W.
        """
    @property
    def over(self, /) -> bool:
        """
        OVER: an element is pressed harder than F2.
        """
    @property
    def position(self, /) -> Incomplete:
        """
        The dome's centre [3], m, in W, by the encoders.
        """
    @property
    def resultant(self, /) -> Incomplete:
        """
        Resultant force on the fingertip by what it touches [3], N, in W.
        """
    @property
    def rotation(self, /) -> Incomplete:
        """
        From the fingertip's frame `T` to W [3, 3].
        """
    @property
    def shear_rate(self, /) -> Incomplete:
        """
        Rate of each element's shear force [E], N/s.
        """
    @property
    def slip(self, /) -> bool:
        """
        SLIP: an element's shear force changes faster than dr.
        """
    @property
    def touch(self, /) -> bool:
        """
        TOUCH: an element is pressed harder than F1, or slips.
        """

@final
class HandSense:
    """
    What the whole hand feels in one control step.
    """
    def __repr__(self, /) -> str: ...
    @property
    def fingers(self, /) -> list[FingerSense]:
        """
        What each finger feels.
        """
    @property
    def time(self, /) -> float:
        """
        Time of the control step, s.
        """

@final
class Layout:
    """
    Where a sensor's elements are in its pictures.
    """
    def centres(self, /) -> Incomplete:
        """
        Column and row of each element's centre, px [E, 2].
        """
    @property
    def dark_level(self, /) -> int: ...
    @property
    def element_count(self, /) -> int: ...
    @property
    def has_dome(self, /) -> bool: ...
    @staticmethod
    def parse(text: str, warnings: SupportsGetItem[int, str] = ...) -> Layout:
        """
        Parses the layout in `text` (TOML); `warnings` are those about its pictures.
        """
    @property
    def picture_size(self, /) -> tuple[int, int]:
        """
        Columns and rows of the pictures, px.
        """
    @property
    def polarity(self, /) -> str:
        """
        Whether the elements are bright or dark.
        """
    def radii(self, /) -> Incomplete:
        """
        Radius of each element's sub-region, px [E].
        """
    def to_toml(self, /) -> str: ...
    @property
    def warnings(self, /) -> list[str]: ...

@final
class ManyEnvironments:
    """
    Environments that step together, on threads.
    """
    def __new__(cls, /, experiment: str, settings: SupportsGetItem[int, str], vary: SupportsGetItem[int, str], action: str, count: SupportsIndex, threads: SupportsIndex, autoreset: str) -> ManyEnvironments: ...
    def guide(self, /, actions: Incomplete) -> None:
        """
        Writes the actions [n, A] that follow the tasks' plans.
        """
    def last(self, /, index: SupportsIndex, observation: Incomplete, info: Incomplete) -> bool:
        """
        Writes the observation and info with which the episode of environment `index` ended, if the newest step ended it and
        began another; whether it did.
        """
    def render(self, /, index: SupportsIndex, picture: Incomplete) -> None:
        """
        Draws the scene of environment `index` as it is into `picture` [H, W, 3].
        """
    def reset(self, /, seeds: SupportsGetItem[int, SupportsIndex | None], mask: Incomplete | None, results: tuple[Incomplete, Incomplete, Incomplete, Incomplete, Incomplete]) -> None:
        """
        Begins an episode in each environment, or in each for which `mask` has `true`.
        """
    def spec(self, /) -> EnvironmentSpec: ...
    def step(self, /, actions: Incomplete, results: tuple[Incomplete, Incomplete, Incomplete, Incomplete, Incomplete]) -> None:
        """
        Makes a control step in each environment, with `actions` [n, A].
        """
    def stop_reason(self, /, index: SupportsIndex) -> str | None:
        """
        Why the hand of environment `index` was stopped, if it was.
        """

@final
class Plan:
    """
    What a task wants of a finger.
    """
    def __new__(cls, /, velocity: SupportsLenAndGetItem[SupportsFloat | SupportsIndex], towards_object: SupportsLenAndGetItem[SupportsFloat | SupportsIndex] = ..., *, reflex: bool = False, keep_grasp: bool = False) -> Plan: ...
    def __repr__(self, /) -> str: ...
    @property
    def keep_grasp(self, /) -> bool:
        """
        Whether the finger re-compresses when its grasp force is low.
        """
    @property
    def reflex(self, /) -> bool:
        """
        Whether the finger re-compresses when it slips.
        """
    @property
    def towards_object(self, /) -> Incomplete:
        """
        Where the object is thought to be: a unit vector [3] in W.
        """
    @property
    def velocity(self, /) -> Incomplete:
        """
        Velocity of the fingertip [3], m/s, in W.
        """

@final
class Recording:
    """
    What was read of a recording.
    """
    def __new__(cls, /, path: str | PathLike[str]) -> Recording:
        """
        Reads the recording at `path`, as far as it goes.
        """
    @property
    def columns(self, /) -> dict:
        """
        Columns by name.
        """
    @property
    def complete(self, /) -> bool:
        """
        Whether it is whole.
        """
    @property
    def digest(self, /) -> str: ...
    @property
    def elements(self, /) -> int:
        """
        Elements of the finger that has most.
        """
    @property
    def end(self, /) -> tuple[str, str | None]:
        """
        How the run ended, and why, if it did not end as it should have.
        """
    @property
    def experiment(self, /) -> str:
        """
        The experiment as run (TOML).
        """
    @property
    def fingers(self, /) -> int: ...
    def frame_count(self, /, finger: SupportsIndex) -> int:
        """
        Number of pictures on record of `finger`.
        """
    def frames(self, /, finger: SupportsIndex, start: SupportsIndex, stop: SupportsIndex) -> tuple[Incomplete, Incomplete]:
        """
        Pictures `start` to `stop` of `finger` [N, H, W], and their times [N], s.
        """
    @property
    def problem(self, /) -> str | None:
        """
        What is wrong with it, if it is not.
        """

@final
class RunOutcome:
    """
    What came of a run.
    """
    @property
    def folder(self, /) -> Path: ...
    @property
    def reason(self, /) -> str | None: ...
    @property
    def simulated_time(self, /) -> float: ...
    @property
    def state(self, /) -> str: ...
    @property
    def summary(self, /) -> str:
        """
        What stands in `summary.json`.
        """
    @property
    def wall_time(self, /) -> float: ...

@final
class Sensor:
    """
    The sensing of one fingertip.
    """
    def __new__(cls, /, calibration: Calibration | None, layout: Layout | None, experiment: str | None, finger: SupportsIndex | None, drift_correction: bool, max_saturated: SupportsFloat | SupportsIndex | None) -> Sensor:
        """
        The sensor of `calibration`, or without one of `layout` or the experiment's fingertip.
        """
    def centres(self, /) -> Incomplete:
        """
        Column and row of each element's centre, px [E, 2].
        """
    @property
    def element_count(self, /) -> int: ...
    @property
    def is_calibrated(self, /) -> bool: ...
    @property
    def picture_size(self, /) -> tuple[int, int]:
        """
        Columns and rows of the pictures, px.
        """
    def reference(self, /) -> list[tuple[float, float] | None] | None:
        """
        The mean centroids that displacements count from, if they were set: column and row of each element; none for one that was dark.
        """
    def rotations(self, /) -> Incomplete | None:
        """
        From each element's frame `E_i` to `T` [E, 3, 3]; none if the dome is not known.
        """
    def sense(self, /, frames: Incomplete, force: Incomplete, valid: Incomplete, gray: Incomplete, displacement: Incomplete, threads: SupportsIndex) -> None:
        """
        Fills `force` [N, E, 3], `valid` [N, E], `gray` [N, E] and `displacement` [N, E, 2] with what is sensed in
        `frames` [N, H, W], on up to `threads` threads.
        """
    def tips(self, /) -> Incomplete | None:
        """
        Tip of each unloaded feeler, m, in `T` [E, 3]; none if the dome is not known.
        """
    def with_reference(self, /, frames: Incomplete) -> Sensor:
        """
        The same sensor, whose displacements count from the mean centroids in `frames` [N, H, W].
        """
    def with_reference_at(self, /, centroids: SupportsGetItem[int, tuple[SupportsFloat | SupportsIndex, SupportsFloat | SupportsIndex] | None]) -> Sensor:
        """
        The same sensor, whose displacements count from these centroids.
        """

@final
class Session:
    """
    A control loop under way, and its recording.
    """
    def __new__(cls, /, experiment: str, settings: SupportsGetItem[int, str], out: str | PathLike[str] | None, task: Any | None, homes: SupportsGetItem[int, SupportsLenAndGetItem[SupportsFloat | SupportsIndex]] | None, law: SupportsGetItem[int, Any] | None) -> Session:
        """
        Sets up `experiment` with `settings`, recorded in the folder `out` if there is one; with `task`, whose fingers start
        from `homes`, and `law` in place of its own.
        """
    def act(self, /, velocity: Incomplete | None) -> None:
        """
        Moves the fingers: at `velocity` [F, 3], m/s in W, or as the laws say.
        """
    def close(self, /, interrupted: bool) -> RunOutcome | None:
        """
        Closes the recording, if there is one, and makes its report.
        """
    def findings(self, /) -> tuple[list[tuple[str, float]], str | None]:
        """
        What the task found out so far, by name, and what came of it.
        """
    @property
    def period(self, /) -> float:
        """
        Control period, s.
        """
    def plan(self, /) -> tuple[HandSense, list[Plan]] | None:
        """
        Reads hand and sensors and asks the task; none once the run is finished, else what the hand feels and what the task
        wants of each finger.
        """
    def resume(self, /) -> None:
        """
        Lets a hand that was stopped go on.
        """
    def stands(self, /) -> tuple[str, int, str | None]:
        """
        Phase of the task, stroke, and why the hand was stopped, if it was.
        """
    def stop(self, /, by: str) -> None:
        """
        Stops the hand, as `by` says.
        """

@final
class SingleEnvironment:
    """
    An experiment as episodes.
    """
    def __new__(cls, /, experiment: str, settings: SupportsGetItem[int, str], vary: SupportsGetItem[int, str], action: str) -> SingleEnvironment: ...
    def guide(self, /, action: Incomplete) -> None:
        """
        Writes the action that follows the task's plan.
        """
    def render(self, /, picture: Incomplete) -> None:
        """
        Draws the scene as it is into `picture` [H, W, 3].
        """
    def reset(self, /, seed: SupportsIndex | None, observation: Incomplete, info: Incomplete) -> int:
        """
        Begins the episode of `seed`, or of one that follows from the last one given. Its seed.
        """
    def reset_to(self, /, seed: SupportsIndex, following: SupportsIndex, observation: Incomplete, info: Incomplete) -> int:
        """
        Begins the episode that comes so many after that of `seed` where no other seed is given. Its seed.
        """
    def spec(self, /) -> EnvironmentSpec: ...
    def step(self, /, action: Incomplete, observation: Incomplete, info: Incomplete) -> tuple[float, bool, bool]:
        """
        Makes a control step: reward, terminated, truncated.
        """
    def stop_reason(self, /) -> str | None:
        """
        Why the hand was stopped, if it was.
        """

@final
class Store:
    """
    The folder of a sweep, open for rows.
    """
    def __new__(cls, /, folder: str | PathLike[str], trials: Trials, resume: bool) -> Store:
        """
        The new folder of `trials`, or with `resume` that in which they were stopped.
        """
    def finish(self, /) -> None:
        """
        Puts the sorted table in place of the growing one, and makes the page.
        """
    @property
    def finished(self, /) -> int:
        """
        How many trials are finished.
        """
    def missing(self, /) -> list[int]:
        """
        The trials that are not finished.
        """
    def push(self, /, rows: bytes) -> None:
        """
        Takes in rows as `Trials.run` returns them.
        """
    def run(self, /, jobs: SupportsIndex | None, progress: Any | None) -> None:
        """
        Runs what is missing here, `jobs` trials at a time; one for each core if none are given. `progress` is called with the
        number of finished trials, now and then.
        """

@final
class Trials:
    """
    The trials of a sweep.
    """
    def __new__(cls, /, plan: str, folder: str | PathLike[str] | None) -> Trials:
        """
        The trials of a plan, the text of `sweep.toml`, on a machine where the files that it names are in `folder`, if it
        names any.
        """
    @property
    def count(self, /) -> int:
        """
        How many there are.
        """
    def files(self, /) -> dict:
        """
        The files that trials may read (bytes), by the name that the experiment has for each.
        """
    @property
    def plan(self, /) -> str:
        """
        The text of `sweep.toml`.
        """
    @staticmethod
    def planned(experiment: str, settings: SupportsGetItem[int, str], vary: SupportsGetItem[int, str], seed: SupportsIndex, count: SupportsIndex, resume: str | PathLike[str] | None) -> Trials:
        """
        `count` trials of `experiment` with `settings` that vary as `vary` says; those that were stopped in the folder
        `resume`, if one is given, which must be the same.
        """
    def run(self, /, trials: SupportsGetItem[int, SupportsIndex], progress: Any | None = None) -> bytes:
        """
        Runs the trials of these numbers one after the other; their rows as a table with header (CSV). `progress` is called
        with the number of finished ones, now and then.
        """

def calibrate_file(path: str | PathLike[str], how: Incomplete) -> Calibration:
    """
    Fits a calibration to the loads in the CSV file at `path`.
    """

def calibrate_frames(frames: Incomplete, forces: Incomplete, how: Incomplete) -> Calibration:
    """
    Fits a calibration to `frames` [N, H, W] under `forces` [N, E, 3], N; not a number where a force is not known.
    """

def locate(frames: Incomplete, polarity: str | None, spot_diameter: SupportsFloat | SupportsIndex | None, element_diameter: SupportsFloat | SupportsIndex | None, region_radius: SupportsFloat | SupportsIndex, dome: str | None) -> Layout:
    """
    Finds the elements in the mean of `frames` [N, H, W] of the untouched sensor.
    """

def raise_flags(force: Incomplete, stamps: Incomplete, thresholds: tuple[SupportsFloat | SupportsIndex, SupportsFloat | SupportsIndex, SupportsFloat | SupportsIndex], flags: tuple[Incomplete, Incomplete, Incomplete, Incomplete, Incomplete]) -> None:
    """
    Fills shear rate, TOUCH, SLIP, OVER and grasp force by `force` [N, E, 3] at `stamps` [N] with the thresholds F1, F2 and
    dr.
    """

def read_table(path: str | PathLike[str]) -> dict:
    """
    The columns of the table at `path` by name: arrays, or lists of words.
    """

def report(folder: str | PathLike[str]) -> None:
    """
    Makes the report of the run in `folder` again.
    """

def run(experiment: str, settings: SupportsGetItem[int, str], out: str | PathLike[str] | None, record_frames: bool, progress: Any | None) -> RunOutcome:
    """
    Runs `experiment` with `settings` and records it in the folder `out`, or in one of its own in `runs`. `progress` is
    called with the simulated time, s, now and then.
    """

def simulate_loads(experiment: str, finger: SupportsIndex | None, combined: SupportsIndex, seed: SupportsIndex) -> tuple[Incomplete, Incomplete]:
    """
    Pictures of the simulated fingertip of `experiment` [N, H, W] under known loads [N, E, 3], N.
    """
