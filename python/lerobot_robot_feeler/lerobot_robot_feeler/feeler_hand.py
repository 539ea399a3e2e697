"""The hand as a robot of LeRobot."""

from __future__ import annotations

import json
import math
import subprocess
import time
from functools import cached_property
from typing import Any

import numpy as np
from lerobot.robots.robot import Robot
from lerobot.utils.errors import DeviceAlreadyConnectedError, DeviceNotConnectedError
from numpy.typing import NDArray

from lerobot_robot_feeler.config_feeler_hand import FeelerHandConfig
from lerobot_robot_feeler.program import Program, ProgramError

AXES = "xyz"
FLAGS = ("touch", "slip", "over")
POLL_INTERVAL = 0.05  # s, while waiting for the programs of the rig


class StaleObservationError(RuntimeError):
    """Joint angles or forces are older than ``max_age``."""


class HandStoppedError(RuntimeError):
    """The hand is stopped and executes no action until it is resumed."""


class FeelerHand(Robot):
    """A hand whose motion LeRobot commands, within the limits of the experiment.

    Observation: for each joint its position (rad, or m), for each finger the force on each element (N, in the element's
    frame), TOUCH, SLIP and OVER (0 or 1), the grasp force (N) and the age of the forces (s). All are single numbers, because
    LeRobot only accepts those and images; :meth:`data_set_features` returns arrays with the names of exported data sets.

    Action: for each joint its velocity (rad/s, or m/s). It passes the limits of every command of feeler, and expires after
    ``lifetime``.
    """

    config_class = FeelerHandConfig
    name = "feeler"

    def __init__(self, config: FeelerHandConfig) -> None:
        self._program: Program | None = None
        super().__init__(config)
        self.config = config

    @cached_property
    def hand(self) -> dict[str, Any]:
        """Description of the hand by ``feeler follow --describe``: joints, limits, elements, control period."""
        command = [*self._command, "--describe"]
        try:
            described = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)
        except OSError as error:
            raise ProgramError(f"{command[0]}: {error}; install feeler, or set `program` to its path") from error
        except subprocess.CalledProcessError as error:
            raise ProgramError(f"{' '.join(command)} failed; its message is on standard error") from error
        hand: dict[str, Any] = json.loads(described.stdout)
        return hand

    @property
    def observation_features(self) -> dict[str, type]:
        features = [f"{joint}.pos" for joint in self._joints]
        for finger, described in enumerate(self.hand["fingers"]):
            touch = f"tactile.finger_{finger}"
            features += [f"{touch}.force.{element}.{axis}" for element in range(described["elements"]) for axis in AXES]
            features += [f"{touch}.{name}" for name in (*FLAGS, "grasp_force", "age")]
        return dict.fromkeys(features, float)

    @property
    def action_features(self) -> dict[str, type]:
        return {f"{joint}.vel": float for joint in self._joints}

    @property
    def is_connected(self) -> bool:
        return self._program is not None

    @property
    def is_calibrated(self) -> bool:
        """Always true: fingertips and joints are calibrated by feeler, and a rig without calibration does not start."""
        return True

    def connect(self, calibrate: bool = True) -> None:
        """Starts ``feeler follow`` and waits for the first control step."""
        if self._program is not None:
            raise DeviceAlreadyConnectedError(f"{self} is already connected.")
        program = Program(self._command)
        try:
            end = time.monotonic() + self.config.connect_timeout
            while "waiting" in program.ask({}):
                if time.monotonic() > end:
                    limit = self.config.connect_timeout
                    raise ProgramError(f"the programs of the rig are not complete after {limit} s; see standard error")
                time.sleep(POLL_INTERVAL)
        except BaseException:
            program.close()
            raise
        self._program = program
        self.configure()

    def calibrate(self) -> None:
        """Does nothing: ``feeler calibrate`` and ``feeler drives`` calibrate fingertips and joints."""

    def configure(self) -> None:
        """Does nothing: the experiment configures the hand."""

    def get_observation(self) -> dict[str, float]:
        """Returns the latest readings.

        Raises
        ------
        StaleObservationError
            If they are older than ``max_age``.
        ProgramError
            If ``feeler follow`` has ended.
        """
        return self._observation(self._connected().ask({}))

    def send_action(self, action: dict[str, float]) -> dict[str, float]:
        """Requests joint velocities and waits for the next control step. Returns the velocities that were sent to the drives
        in that step, after limiting.

        Raises
        ------
        ValueError
            If a velocity is missing or not finite.
        HandStoppedError
            If the hand is stopped. ``feeler resume`` resumes it.
        """
        program = self._connected()
        velocities = []
        for finger in self.hand["fingers"]:
            velocities.append([self._velocity(action, f"{joint}.vel") for joint in finger["joints"]])
        answer = program.ask({"velocity": velocities})
        if answer["stopped"] is not None:
            raise HandStoppedError(f"the hand is stopped: {answer['stopped']}")
        sent = zip(self.hand["fingers"], answer["fingers"], strict=True)
        return {
            f"{joint}.vel": float(velocity)
            for described, finger in sent
            for joint, velocity in zip(described["joints"], finger["command"], strict=True)
        }

    def disconnect(self) -> None:
        """Stops the hand and closes its recording."""
        program = self._connected()
        self._program = None
        program.close()

    def data_set_features(self, observation: dict[str, float]) -> dict[str, NDArray[Any]]:
        """Converts an observation to the features of a data set written by ``feeler export lerobot``, for a policy trained
        on it: ``observation.state``, ``observation.tactile.finger_N.force``, ``.flags`` and ``.grasp_force``."""

        def numbers(names: list[str]) -> NDArray[np.float32]:
            return np.array([observation[name] for name in names], dtype=np.float32)

        features: dict[str, NDArray[Any]] = {"observation.state": numbers([f"{joint}.pos" for joint in self._joints])}
        for finger, described in enumerate(self.hand["fingers"]):
            touch = f"tactile.finger_{finger}"
            forces = [f"{touch}.force.{element}.{axis}" for element in range(described["elements"]) for axis in AXES]
            features[f"observation.{touch}.force"] = numbers(forces).reshape(-1, 3)
            features[f"observation.{touch}.flags"] = numbers([f"{touch}.{flag}" for flag in FLAGS]) > 0.5
            features[f"observation.{touch}.grasp_force"] = numbers([f"{touch}.grasp_force"])
        return features

    @property
    def _joints(self) -> list[str]:
        return [joint for finger in self.hand["fingers"] for joint in finger["joints"]]

    @property
    def _command(self) -> list[str]:
        config = self.config
        command = [config.program, "follow", config.experiment, f"--lifetime={config.lifetime}"]
        return [*command, *(["--simulated"] if config.simulated else []), *config.arguments]

    def _connected(self) -> Program:
        if self._program is None:
            raise DeviceNotConnectedError(f"{self} is not connected. Run `.connect()` first.")
        return self._program

    def _velocity(self, action: dict[str, float], name: str) -> float:
        if name not in action:
            raise ValueError(f"action: expected {', '.join(self.action_features)}; {name} is missing")
        velocity = float(action[name])
        if not math.isfinite(velocity):
            raise ValueError(f"action: expected a finite velocity, got {name} = {velocity}")
        return velocity

    def _observation(self, answer: dict[str, Any]) -> dict[str, float]:
        self._check_age("the joint angles", answer["age"], answer)
        observation = {}
        for finger, (described, read) in enumerate(zip(self.hand["fingers"], answer["fingers"], strict=True)):
            for joint, position in zip(described["joints"], read["position"], strict=True):
                observation[f"{joint}.pos"] = float(position)
            sensed_at = read["sensed_at"]
            age = math.inf if sensed_at is None else answer["time"] - sensed_at + answer["age"]
            self._check_age(f"the forces of finger {finger}", age, answer)
            touch = f"tactile.finger_{finger}"
            for element, force in enumerate(read["force"]):
                for axis, component in zip(AXES, force, strict=True):
                    if component is None:
                        raise StaleObservationError(f"element {element} of finger {finger} has no valid force")
                    observation[f"{touch}.force.{element}.{axis}"] = float(component)
            observation |= {f"{touch}.{flag}": float(read[flag]) for flag in FLAGS}
            observation |= {f"{touch}.grasp_force": float(read["grasp_force"]), f"{touch}.age": float(age)}
        return {name: observation[name] for name in self.observation_features}

    def _check_age(self, what: str, age: float, answer: dict[str, Any]) -> None:
        if not age <= self.config.max_age:
            why = f"; the hand is stopped: {answer['stopped']}" if answer["stopped"] else ""
            raise StaleObservationError(f"{what} are {age:.3f} s old, expected at most {self.config.max_age} s{why}")
