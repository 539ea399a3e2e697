"""
Native module of the package `feeler`.
"""

from _typeshed import Incomplete, SupportsGetItem, SupportsLenAndGetItem
from os import PathLike
from pathlib import Path
from typing import Any, Final, SupportsFloat, SupportsIndex, final

__all__ = ["__version__", "Calibration", "EnvironmentSpec", "FingerSense", "HandSense", "Layout", "ManyEnvironments", "Plan", "Recording", "RunOutcome", "Sensor", "Session", "SingleEnvironment", "Store", "Trials", "WrenchEstimator", "calibrate_file", "calibrate_frames", "estimate_contacts", "locate", "raise_flags", "read_table", "report", "run", "simulate_loads"]

__version__: Final[str]

@final
class Calibration:
    """
    Calibration of one fingertip: function from moments to forces.
    """
    @property
    def element_count(self, /) -> int: ...
    def held_out_rms(self, /) -> list[list[float]]:
        """
        Root mean square error on held-out loads along x, y and z of each element, N [E, 3].
        """
    @property
    def model(self, /) -> str: ...
    @staticmethod
    def parse(text: str) -> Calibration:
        """
        Parses a calibration (TOML).
        """
    def report(self, /) -> str:
        """
        Returns the errors of the calibration as text.
        """
    def to_toml(self, /) -> str: ...

@final
class EnvironmentSpec:
    """
    Layout and ranges of an environment's arrays.
    """
    @property
    def action_bounds(self, /) -> list[float]:
        """
        Maximum magnitude of each component of an action that is executed unchanged; larger ones are limited.
        """
    @property
    def high(self, /) -> list[float]:
        """
        Maximum of each component of an observation.
        """
    @property
    def info_names(self, /) -> list[str]:
        """
        Names of the values reported in addition to the reward, with units.
        """
    @property
    def low(self, /) -> list[float]:
        """
        Minimum of each component of an observation.
        """
    @property
    def max_steps(self, /) -> int:
        """
        Maximum number of control steps of an episode.
        """
    @property
    def parts(self, /) -> list[list[tuple[str, str, int, int]]]:
        """
        Parts of each finger's observation: name, unit, start index and end index.
        """
    @property
    def period(self, /) -> float:
        """
        Control period, s.
        """

@final
class FingerSense:
    """
    Readings and pose of one finger.
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
        Joint positions, one per joint [J], rad, or m for a prismatic joint.
        """
    @property
    def joint_velocity(self, /) -> Incomplete:
        """
        Joint velocities, one per joint [J], rad/s, or m/s for a prismatic joint.
        """
    @property
    def largest_element(self, /) -> int | None:
        """
        Touching element with the largest compression, or `None` if no element touches.
        """
    @property
    def normal(self, /) -> Incomplete:
        """
        The dome's outward normal at each element [E, 3], unit vectors in W.
        """
    @property
    def over(self, /) -> bool:
        """
        OVER: the compression of an element is above the threshold F2.
        """
    @property
    def position(self, /) -> Incomplete:
        """
        Position of the dome's centre [3], m, in W, from the encoders.
        """
    @property
    def resultant(self, /) -> Incomplete:
        """
        Resultant force on the fingertip by the object [3], N, in W.
        """
    @property
    def rotation(self, /) -> Incomplete:
        """
        Rotation from the fingertip's frame `T` to W [3, 3].
        """
    @property
    def shear_rate(self, /) -> Incomplete:
        """
        Shear rate of each element [E], N/s.
        """
    @property
    def slip(self, /) -> bool:
        """
        SLIP: the shear rate of an element is above the threshold dr.
        """
    @property
    def touch(self, /) -> bool:
        """
        TOUCH: the compression of an element is above the threshold F1, or SLIP is raised.
        """

@final
class HandSense:
    """
    Readings of the whole hand in one control step.
    """
    def __repr__(self, /) -> str: ...
    @property
    def fingers(self, /) -> list[FingerSense]:
        """
        Readings of each finger.
        """
    @property
    def time(self, /) -> float:
        """
        Time of the control step, s.
        """

@final
class Layout:
    """
    Positions of a sensor's elements in its images.
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
        Parses the layout in `text` (TOML); `warnings` are those about the images from which it was located.
        """
    @property
    def picture_size(self, /) -> tuple[int, int]:
        """
        Width and height of the images, px.
        """
    @property
    def polarity(self, /) -> str:
        """
        Polarity of the elements: bright or dark.
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
    Environments that are stepped together, on threads.
    """
    def __new__(cls, /, experiment: str, settings: SupportsGetItem[int, str], vary: SupportsGetItem[int, str], action: str, count: SupportsIndex, threads: SupportsIndex, autoreset: str) -> ManyEnvironments: ...
    def guide(self, /, actions: Incomplete) -> None:
        """
        Writes the actions [n, A] that execute the tasks' plans.
        """
    def last(self, /, index: SupportsIndex, observation: Incomplete, info: Incomplete) -> bool:
        """
        If the latest step ended an episode of environment `index` and began another, writes the final observation and
        info of the ended episode and returns `true`.
        """
    def render(self, /, index: SupportsIndex, picture: Incomplete) -> None:
        """
        Renders the current scene of environment `index` into `picture` [H, W, 3].
        """
    def reset(self, /, seeds: SupportsGetItem[int, SupportsIndex | None], mask: Incomplete | None, results: tuple[Incomplete, Incomplete, Incomplete, Incomplete, Incomplete]) -> None:
        """
        Begins an episode in each environment, or in each for which `mask` is `true`.
        """
    def spec(self, /) -> EnvironmentSpec: ...
    def step(self, /, actions: Incomplete, results: tuple[Incomplete, Incomplete, Incomplete, Incomplete, Incomplete]) -> None:
        """
        Runs one control step in each environment, with `actions` [n, A].
        """
    def stop_reason(self, /, index: SupportsIndex) -> str | None:
        """
        Reason why the hand of environment `index` was stopped, or `None` if it is not stopped.
        """

@final
class Plan:
    """
    Motion that a task plans for a finger.
    """
    def __new__(cls, /, velocity: SupportsLenAndGetItem[SupportsFloat | SupportsIndex], towards_object: SupportsLenAndGetItem[SupportsFloat | SupportsIndex] = ..., *, reflex: bool = False, keep_grasp: bool = False) -> Plan: ...
    def __repr__(self, /) -> str: ...
    @property
    def keep_grasp(self, /) -> bool:
        """
        `True` if the finger is re-compressed when its grasp force is low.
        """
    @property
    def reflex(self, /) -> bool:
        """
        `True` if the finger is re-compressed when it slips.
        """
    @property
    def towards_object(self, /) -> Incomplete:
        """
        Assumed direction to the object, a unit vector [3] in W.
        """
    @property
    def velocity(self, /) -> Incomplete:
        """
        Velocity of the fingertip [3], m/s, in W.
        """

@final
class Recording:
    """
    Content of a recording.
    """
    def __new__(cls, /, path: str | PathLike[str]) -> Recording:
        """
        Reads the recording at `path`, up to the first damaged part, if any.
        """
    @property
    def columns(self, /) -> dict:
        """
        Columns by name.
        """
    @property
    def complete(self, /) -> bool:
        """
        `True` if the recording is complete.
        """
    @property
    def digest(self, /) -> str: ...
    @property
    def elements(self, /) -> int:
        """
        Maximum number of elements of a finger.
        """
    @property
    def end(self, /) -> tuple[str, str | None]:
        """
        State in which the run ended, and the reason if it ended early.
        """
    @property
    def experiment(self, /) -> str:
        """
        The experiment of the run (TOML).
        """
    @property
    def fingers(self, /) -> int: ...
    def frame_count(self, /, finger: SupportsIndex) -> int:
        """
        Number of recorded frames of `finger`.
        """
    def frames(self, /, finger: SupportsIndex, start: SupportsIndex, stop: SupportsIndex) -> tuple[Incomplete, Incomplete]:
        """
        Returns the frames `start` to `stop` of `finger` [N, H, W], and their times [N], s.
        """
    @property
    def problem(self, /) -> str | None:
        """
        Description of the damage, or `None` if the recording is complete.
        """

@final
class RunOutcome:
    """
    Result of a run.
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
        Content of `summary.json`.
        """
    @property
    def wall_time(self, /) -> float: ...

@final
class Sensor:
    """
    Sensing chain of one fingertip: from frames to moments and forces.
    """
    def __new__(cls, /, calibration: Calibration | None, layout: Layout | None, experiment: str | None, finger: SupportsIndex | None, drift_correction: bool, max_saturated: SupportsFloat | SupportsIndex | None) -> Sensor:
        """
        Creates the sensor of `calibration`; without one, that of `layout` or of the experiment's fingertip.
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
        Width and height of the frames, px.
        """
    def reference(self, /) -> list[tuple[float, float] | None] | None:
        """
        Column and row of each element's reference centroid, or `None` if no reference was set. The entry of an
        element that was dark is `None`.
        """
    def rotations(self, /) -> Incomplete | None:
        """
        Rotation from each element's frame `E_i` to `T` [E, 3, 3], or `None` if the dome is not known.
        """
    def sense(self, /, frames: Incomplete, force: Incomplete, valid: Incomplete, gray: Incomplete, displacement: Incomplete, threads: SupportsIndex) -> None:
        """
        Fills `force` [N, E, 3], `valid` [N, E], `gray` [N, E] and `displacement` [N, E, 2] from `frames` [N, H, W],
        on up to `threads` threads.
        """
    def tips(self, /) -> Incomplete | None:
        """
        Tip of each unloaded feeler, m, in `T` [E, 3], or `None` if the dome is not known.
        """
    def with_reference(self, /, frames: Incomplete) -> Sensor:
        """
        Returns a copy of the sensor whose displacements are relative to the mean centroids in `frames` [N, H, W].
        """
    def with_reference_at(self, /, centroids: SupportsGetItem[int, tuple[SupportsFloat | SupportsIndex, SupportsFloat | SupportsIndex] | None]) -> Sensor:
        """
        Returns a copy of the sensor whose displacements are relative to these centroids.
        """

@final
class Session:
    """
    A control loop in progress, with its recording.
    """
    def __new__(cls, /, experiment: str, settings: SupportsGetItem[int, str], out: str | PathLike[str] | None, task: Any | None, homes: SupportsGetItem[int, SupportsLenAndGetItem[SupportsFloat | SupportsIndex]] | None, law: SupportsGetItem[int, Any] | None) -> Session:
        """
        Creates a session of `experiment` with `settings`, recorded in the folder `out` if given. `task`, in which the
        fingers start from `homes`, and `law` replace those of the experiment.
        """
    def act(self, /, velocity: Incomplete | None) -> None:
        """
        Moves the fingers at `velocity` [F, 3], m/s in W; if it is `None`, as the control laws command.
        """
    def close(self, /, interrupted: bool) -> RunOutcome | None:
        """
        Closes the recording, if any, and writes its report.
        """
    def findings(self, /) -> tuple[list[tuple[str, float]], str | None]:
        """
        Returns the findings of the task so far by name, and its outcome.
        """
    @property
    def period(self, /) -> float:
        """
        Control period, s.
        """
    def plan(self, /) -> tuple[HandSense, list[Plan]] | None:
        """
        Reads hand and sensors and updates the task. Returns the readings of the hand and the plan of each finger, or
        `None` once the run is finished.
        """
    def resume(self, /) -> None:
        """
        Resumes after a stop.
        """
    def stands(self, /) -> tuple[str, int, str | None]:
        """
        Returns the phase of the task, the stroke, and the reason of a stop, if any.
        """
    def stop(self, /, by: str) -> None:
        """
        Stops the hand; `by` names the source of the request.
        """

@final
class SingleEnvironment:
    """
    An environment that runs an experiment in episodes.
    """
    def __new__(cls, /, experiment: str, settings: SupportsGetItem[int, str], vary: SupportsGetItem[int, str], action: str) -> SingleEnvironment: ...
    def guide(self, /, action: Incomplete) -> None:
        """
        Writes the action that executes the task's plan.
        """
    def render(self, /, picture: Incomplete) -> None:
        """
        Renders the current scene into `picture` [H, W, 3].
        """
    def reset(self, /, seed: SupportsIndex | None, observation: Incomplete, info: Incomplete) -> int:
        """
        Begins the episode of `seed`; if it is `None`, the seed is derived from the last given one. Returns the seed.
        """
    def reset_to(self, /, seed: SupportsIndex, following: SupportsIndex, observation: Incomplete, info: Incomplete) -> int:
        """
        Begins the episode that would follow after `following` resets without a seed, starting from the episode of
        `seed`. Returns its seed.
        """
    def spec(self, /) -> EnvironmentSpec: ...
    def step(self, /, action: Incomplete, observation: Incomplete, info: Incomplete) -> tuple[float, bool, bool]:
        """
        Runs one control step. Returns the reward, terminated and truncated.
        """
    def stop_reason(self, /) -> str | None:
        """
        Reason why the hand was stopped, or `None` if it is not stopped.
        """

@final
class Store:
    """
    The folder of a sweep, to which rows can be added.
    """
    def __new__(cls, /, folder: str | PathLike[str], trials: Trials, resume: bool) -> Store:
        """
        Creates the folder of `trials`. With `resume`, opens the folder in which they were interrupted.
        """
    def finish(self, /) -> None:
        """
        Replaces the table of rows in order of completion by the sorted table, and writes the page.
        """
    @property
    def finished(self, /) -> int:
        """
        Number of finished trials.
        """
    def missing(self, /) -> list[int]:
        """
        Returns the unfinished trials.
        """
    def push(self, /, rows: bytes) -> None:
        """
        Adds rows as returned by `Trials.run`.
        """
    def run(self, /, jobs: SupportsIndex | None, progress: Any | None) -> None:
        """
        Runs the missing trials in this process, `jobs` at a time, by default one per core. `progress` is called
        periodically with the number of finished trials.
        """

@final
class Trials:
    """
    The trials of a sweep.
    """
    def __new__(cls, /, plan: str, folder: str | PathLike[str] | None) -> Trials:
        """
        Parses a plan, the text of `sweep.toml`. If `folder` is given, it must contain the files that the plan names.
        """
    @property
    def count(self, /) -> int:
        """
        Number of trials.
        """
    def files(self, /) -> dict:
        """
        Returns the files that trials may read (bytes), by the name that the experiment uses for each.
        """
    @property
    def plan(self, /) -> str:
        """
        The text of `sweep.toml`.
        """
    @staticmethod
    def planned(experiment: str, settings: SupportsGetItem[int, str], vary: SupportsGetItem[int, str], seed: SupportsIndex, count: SupportsIndex, resume: str | PathLike[str] | None) -> Trials:
        """
        Plans `count` trials of `experiment` with `settings` and the variations `vary`. With `resume`, continues the
        interrupted sweep in that folder, which must have the same plan.
        """
    def run(self, /, trials: SupportsGetItem[int, SupportsIndex], progress: Any | None = None) -> bytes:
        """
        Runs the given trials one after the other and returns their rows as a table with a header (CSV). `progress` is
        called periodically with the number of finished trials.
        """

@final
class WrenchEstimator:
    """
    Estimator of the total force on one fingertip.
    """
    def __new__(cls, /, text: str, layout: Layout | None, experiment: str | None, finger: SupportsIndex | None) -> WrenchEstimator:
        """
        Creates the estimator of the calibration in `text` (TOML). A camera's calibration requires a `layout` or an
        `experiment`.
        """
    @property
    def element_count(self, /) -> int: ...
    def estimate(self, /, frames: Incomplete) -> tuple[Incomplete, Incomplete, Incomplete]:
        """
        Estimates the wrench in each of `frames` [N, H, W].
        """
    def estimate_taxels(self, /, readings: Incomplete, stamps: Incomplete) -> tuple[Incomplete, Incomplete, Incomplete]:
        """
        Estimates the wrench for each row of `readings` [N, E, 3] at `stamps` [N], s. The rows are one sequence that
        begins without load.
        """
    @property
    def picture_size(self, /) -> tuple[int, int] | None:
        """
        Width and height of the images, px; `None` for taxels.
        """

def calibrate_file(path: str | PathLike[str], how: Incomplete) -> Calibration:
    """
    Fits a calibration to the loads in the CSV file at `path`.
    """

def calibrate_frames(frames: Incomplete, forces: Incomplete, how: Incomplete) -> Calibration:
    """
    Fits a calibration to `frames` [N, H, W] under `forces` [N, E, 3], N; NaN for unknown forces.
    """

def estimate_contacts(force: Incomplete, tips: Incomplete, rotations: Incomplete, touch: SupportsFloat | SupportsIndex, friction: SupportsFloat | SupportsIndex | None) -> dict:
    """
    Estimates the contact in each frame of `force` [N, E, 3] on elements at `tips` [E, 3] with `rotations` [E, 3, 3] to
    `T`. Returns arrays by name, [N] or [N, width].
    """

def locate(frames: Incomplete, polarity: str | None, spot_diameter: SupportsFloat | SupportsIndex | None, element_diameter: SupportsFloat | SupportsIndex | None, region_radius: SupportsFloat | SupportsIndex, dome: str | None) -> Layout:
    """
    Locates the elements in the mean of `frames` [N, H, W] of the untouched sensor.
    """

def raise_flags(force: Incomplete, stamps: Incomplete, thresholds: tuple[SupportsFloat | SupportsIndex, SupportsFloat | SupportsIndex, SupportsFloat | SupportsIndex], flags: tuple[Incomplete, Incomplete, Incomplete, Incomplete, Incomplete]) -> None:
    """
    Computes shear rate, TOUCH, SLIP, OVER and grasp force from `force` [N, E, 3] at `stamps` [N] with the thresholds
    F1, F2 and dr.
    """

def read_table(path: str | PathLike[str]) -> dict:
    """
    Returns the columns of the table at `path` by name, as arrays or lists of text.
    """

def report(folder: str | PathLike[str]) -> None:
    """
    Recreates the report of the run in `folder`.
    """

def run(experiment: str, settings: SupportsGetItem[int, str], out: str | PathLike[str] | None, record_frames: bool, progress: Any | None) -> RunOutcome:
    """
    Runs `experiment` with `settings` and records it in the folder `out`, or in a new folder in `runs`. `progress` is
    called periodically with the simulated time, s.
    """

def simulate_loads(experiment: str, finger: SupportsIndex | None, combined: SupportsIndex, seed: SupportsIndex) -> tuple[Incomplete, Incomplete]:
    """
    Returns images of the simulated fingertip of `experiment` [N, H, W] with their loads [N, E, 3], N.
    """
