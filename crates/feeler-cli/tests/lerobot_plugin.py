"""Operates a hand as a robot of LeRobot, which finds the plug-in by name, and prints what it finds as JSON.

    lerobot_plugin.py FEELER EXPERIMENT [ARGUMENT...]

Arguments are those of `feeler follow`; with `--simulated` the rig is simulated, otherwise its programs must run.
If PyTorch is missing, empty modules take its place.
"""

import importlib.util
import json
import sys
import time
from dataclasses import dataclass
from importlib.machinery import ModuleSpec
from types import ModuleType


class AbsentType(type):
    """Type whose attributes are types, too."""

    def __getattr__(cls, name):
        return absent(name)


def absent(name):
    """Returns a type, which annotations, base classes and decorators may name."""
    if name.startswith("__"):
        raise AttributeError(name)
    return AbsentType(name, (), {"__init__": lambda self, *args, **kwargs: None, "__call__": lambda self, f: f})


class Absent(ModuleType):
    """Module, and package, whose attributes are types."""

    __path__ = ()

    def __getattr__(self, name):
        return absent(name)


class AbsentPackages:
    """Finds an empty module in place of each missing package and of its modules."""

    def __init__(self, *names):
        self.names = [name for name in names if importlib.util.find_spec(name) is None]

    def find_spec(self, name, path=None, target=None):
        return ModuleSpec(name, self, is_package=True) if name.partition(".")[0] in self.names else None

    def create_module(self, spec):
        return Absent(spec.name)

    def exec_module(self, module):
        pass


# LeRobot imports these packages, which robots do not use.
sys.meta_path.append(AbsentPackages("torch", "torchvision", "safetensors"))

import draccus  # noqa: E402
import numpy as np  # noqa: E402
from lerobot.robots import RobotConfig, make_robot_from_config  # noqa: E402
from lerobot.utils.constants import ACTION, OBS_STR  # noqa: E402
from lerobot.utils.feature_utils import build_dataset_frame, hw_to_dataset_features  # noqa: E402
from lerobot.utils.import_utils import register_third_party_plugins  # noqa: E402

register_third_party_plugins()

SPEED = 0.05  # rad/s


@dataclass
class Script:
    """Options of a script, as LeRobot's scripts declare them."""

    robot: RobotConfig


def raised(call):
    """Name and message of the error of a call."""
    try:
        call()
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    return None


def now(robot):
    """Time of the hand, s."""
    return robot._program.ask({})["time"]


def wait(robot, seconds):
    """Waits until the hand's time has advanced."""
    end = now(robot) + seconds
    while now(robot) < end:
        time.sleep(0.01)


def loses_its_program(robot, action):
    """Connects again, kills the program, and returns the errors of observing and acting."""
    # In another folder, as the first one contains a run.
    others = [argument for argument in robot.config.arguments if not argument.startswith("--out")]
    robot.config.arguments = [*others, "--out=lost"]
    robot.connect()
    robot._program.process.kill()
    robot._program.process.wait()
    errors = [raised(robot.get_observation), raised(lambda: robot.send_action(action))]
    robot.disconnect()
    return errors


def main():
    program, experiment, *arguments = sys.argv[1:]
    simulated = "--simulated" in arguments
    arguments = [argument for argument in arguments if argument != "--simulated"]
    values = {"type": "feeler", "id": "test", "experiment": experiment, "program": program, "max_age": 1.0}
    values |= {"simulated": str(simulated).lower(), "arguments": json.dumps(arguments)}
    config = draccus.parse(Script, args=[f"--robot.{key}={value}" for key, value in values.items()]).robot
    robot = make_robot_from_config(config)
    said = {"class": f"{type(robot).__module__}.{type(robot).__name__}", "name": robot.name, "type": config.type}
    said["unconnected"] = [raised(robot.get_observation), raised(lambda: robot.send_action({})), raised(robot.disconnect)]
    features, actions = robot.observation_features, robot.action_features
    said["actions"] = list(actions)
    observed = hw_to_dataset_features(features, OBS_STR) | hw_to_dataset_features(actions, ACTION)
    said["data_set"] = {key: [list(feature["shape"]), feature["dtype"]] for key, feature in observed.items()}

    with robot:
        said["twice"] = raised(robot.connect)
        said["calibrated"] = robot.is_calibrated
        first = robot.get_observation()
        said["keys"] = list(first) == list(features)
        frame = build_dataset_frame(observed, first, OBS_STR)
        said["frame"] = bool(np.isfinite(frame["observation.state"]).all())
        said["arrays"] = {key: [list(a.shape), a.dtype.name] for key, a in robot.data_set_features(first).items()}

        # Joint 2 of finger 0 moves, and stands still once the last action has expired.
        moving = dict.fromkeys(actions, 0.0) | {"finger_0_joint_2.vel": -SPEED}
        sent, start = [], now(robot)
        while now(robot) < start + 0.5:
            sent.append(robot.send_action(moving))
        said["sent"] = min(s["finger_0_joint_2.vel"] for s in sent)
        said["others"] = max(abs(v) for s in sent for name, v in s.items() if name != "finger_0_joint_2.vel")
        wait(robot, 2 * config.lifetime)
        stood = robot.get_observation()
        wait(robot, 0.1)
        said["moved"] = stood["finger_0_joint_2.pos"] - first["finger_0_joint_2.pos"]
        said["stands"] = abs(robot.get_observation()["finger_0_joint_2.pos"] - stood["finger_0_joint_2.pos"])

        # An excessive velocity is limited, and the limited one is returned.
        said["limited"] = robot.send_action(moving | {"finger_0_joint_2.vel": -1e6})["finger_0_joint_2.vel"]
        robot.send_action(dict.fromkeys(actions, 0.0))
        said["refused"] = [
            raised(lambda: robot.send_action({})),
            raised(lambda: robot.send_action(moving | {"finger_0_joint_2.vel": float("nan")})),
        ]
        if not simulated:
            # The test ends the rig's program when it reads this line.
            print("the rig may end", flush=True)
            while (said_stale := raised(robot.get_observation)) is None:
                time.sleep(0.02)
            said["stale"] = said_stale
            said["stopped"] = raised(lambda: robot.send_action(moving))
    said["disconnected"] = not robot.is_connected
    if simulated:
        said["lost"] = loses_its_program(robot, moving)
    print(json.dumps(said))


if __name__ == "__main__":
    main()
