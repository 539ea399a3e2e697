"""Computes poses and Jacobians of fingers with Pinocchio and writes them to `chain.json`.

    python3 -m venv target/references
    target/references/bin/pip install pin==4.1.0
    target/references/bin/python crates/feeler/tests/references/chain.py crates/feeler/tests/references/chain.json

`tests/all/chain/pinocchio.rs` compares them with feeler's. Each finger is a URDF text, and is stored as a chain
configuration with one row per URDF joint. Pinocchio reads the text itself.

- leap: index finger of the LEAP Hand. Joint origins, axes, limits and speeds are the numbers of its published
  description (github.com/leap-hand/LEAP_Hand_Sim, MIT licence), rounded to 1e-9; the fingertip frame is assumed.
- allegro: index finger of the Allegro Hand. Numbers of its published description
  (github.com/simlabrobotics/allegro_hand_ros, BSD licence); speeds and the base pose are assumed. The fingertip frame is
  at the centre of the round tip.
- coupled: spreading joint, and one tendon that bends three phalanges. All numbers are assumed.
- skewed: seven joints, one of them prismatic, with axes in general directions. All numbers are assumed.
- gripper: one jaw of a parallel gripper. All numbers are assumed.
"""

import json
import math
import sys
from xml.etree import ElementTree

import numpy as np
import pinocchio

CONFIGURATIONS = 16

# name: (joints, tip origin, tip roll, pitch, yaw). A joint is name, type, xyz, rpy, axis, limits (lower, upper, speed)
# or mimic (joint, multiplier, offset). The first one, `base`, is fixed.
HALF = math.pi / 2
BASE = ("base", "fixed", (0.02, -0.05, 0.11), (0.3, -0.2, 0.7), None, None)
FINGERS = {
    "leap": (
        [
            BASE,
            ("mcp", "revolute", (-0.00709525, 0.023057756, -0.018722404), (HALF, HALF, 0), (0, 0, -1), (-0.314, 2.23, 8.48)),
            ("spread", "revolute", (-0.0122, 0.0381, 0.0145), (-HALF, 0, HALF), (0, 0, -1), (-1.047, 1.047, 8.48)),
            ("pip", "revolute", (0.015, 0.0143, -0.013), (HALF, -HALF, 0), (0, 0, -1), (-0.506, 1.885, 8.48)),
            ("dip", "revolute", (0, -0.0361, 0.0002), (0, 0, 0), (0, 0, -1), (-0.366, 2.042, 8.48)),
        ],
        (0, -0.042, 0.0145),
        (0, 0, -HALF),
    ),
    "allegro": (
        [
            BASE,
            ("spread", "revolute", (0, 0.0435, -0.001542), (-0.08726646255, 0, 0), (0, 0, 1), (-0.47, 0.47, 6.0)),
            ("mcp", "revolute", (0, 0, 0.0164), (0, 0, 0), (0, 1, 0), (-0.196, 1.61, 6.0)),
            ("pip", "revolute", (0, 0, 0.054), (0, 0, 0), (0, 1, 0), (-0.174, 1.709, 6.0)),
            ("dip", "revolute", (0, 0, 0.0384), (0, 0, 0), (0, 1, 0), (-0.227, 1.618, 6.0)),
        ],
        (0, 0, 0.0267),
        (0, -HALF, 0),
    ),
    "coupled": (
        [
            BASE,
            ("spread", "revolute", (0, 0.01, 0.02), (0, 0, 0.1), (1, 0, 0), (-0.4, 0.4, 3.0)),
            ("tendon", "revolute", (0.005, 0, 0.01), (0, 0, 0), (0, 1, 0), (0.0, 1.4, 3.0)),
            ("middle", "revolute", (0, 0, 0.045), (0.05, 0, 0), (0, 1, 0), ("tendon", 1.1, 0.1)),
            ("last", "revolute", (0, 0.001, 0.03), (0, 0, 0), (0, 1, 0), ("tendon", 0.7, -0.05)),
        ],
        (0.002, 0, 0.02),
        (0, -HALF, 0),
    ),
    "skewed": (
        [
            BASE,
            ("a", "revolute", (0.01, 0.02, 0.03), (0.1, 0.2, 0.3), (0.6, 0, 0.8), (-1.5, 1.0, 2.0)),
            ("b", "revolute", (0.05, 0, 0.01), (-0.4, 1.1, 0), (0, 1, 0), (-0.5, 1.5, 3.0)),
            ("c", "prismatic", (0, 0.02, 0.04), (0, 0, 1.3), (0, -0.8, 0.6), (-0.01, 0.04, 0.1)),
            ("d", "revolute", (0.03, 0, 0), (2.0, 0, -0.5), (1, 0, 0), (-2.0, 2.0, 3.0)),
            ("e", "revolute", (0, 0, 0.06), (0.3, 0.3, 0.3), (0, 0, -1), (-1.0, 1.2, 3.0)),
            ("f", "revolute", (0.02, 0.03, 0), (0, -0.7, 0), (0.36, 0.48, 0.8), (-1.0, 2.5, 3.0)),
            ("g", "revolute", (0, 0, 0.04), (0, 0, 0), (0, 1, 0), (-0.3, 1.8, 3.0)),
        ],
        (0.03, 0.002, 0.01),
        (0.2, -0.3, 0.4),
    ),
    "gripper": (
        [
            BASE,
            ("jaw", "prismatic", (0, 0.004, 0.0584), (0, 0, 3.0), (0, -1, 0), (0.0, 0.04, 0.2)),
        ],
        (0.0, -0.01, 0.045),
        (0, 0, -HALF),
    ),
}


def text(numbers):
    return " ".join(repr(float(number)) for number in numbers)


def urdf(joints, tip_xyz, tip_rpy):
    lines, parent = ['<robot name="finger"><link name="world"/>'], "world"
    for name, kind, xyz, rpy, axis, last in [*joints, ("tip", "fixed", tip_xyz, tip_rpy, None, None)]:
        link = f"{name}_link"
        lines.append(f'<link name="{link}"/><joint name="{name}" type="{kind}"><parent link="{parent}"/>')
        lines.append(f'<child link="{link}"/><origin xyz="{text(xyz)}" rpy="{text(rpy)}"/>')
        if axis:
            lines.append(f'<axis xyz="{text(axis)}"/>')
        if last and isinstance(last[0], str):
            lines.append('<limit lower="-9" upper="9" velocity="9" effort="1"/>')
            lines.append(f'<mimic joint="{last[0]}" multiplier="{last[1]!r}" offset="{last[2]!r}"/>')
        elif last:
            lines.append(f'<limit lower="{last[0]!r}" upper="{last[1]!r}" velocity="{last[2]!r}" effort="1"/>')
        lines.append("</joint>")
        parent = link
    return "".join([*lines, "</robot>"])


def numbers(element, attribute, default):
    return [float(n) for n in element.get(attribute, default).split()] if element is not None else default


def chain_config(robot):
    """Chain configuration of a URDF text: a row per joint, the first as the base, the last as the fingertip frame."""
    joints = list(ElementTree.fromstring(robot).iter("joint"))
    origin = [(numbers(j.find("origin"), "xyz", ""), numbers(j.find("origin"), "rpy", "")) for j in joints]
    config = {"base_position": origin[0][0], "base_rpy": origin[0][1], "joints": [], "frames": []}
    for joint, (xyz, rpy) in list(zip(joints, origin))[1:-1]:
        axis = numbers(joint.find("axis"), "xyz", "1 0 0")
        row = {"type": joint.get("type"), "xyz": xyz, "rpy": rpy, "axis": axis}
        mimic, limit = joint.find("mimic"), joint.find("limit")
        if mimic is None:
            row["joint"] = joint.get("name")
            limits = {key: float(limit.get(other)) for key, other in LIMITS.items()}
            config["joints"].append({"name": joint.get("name"), **limits})
        else:
            row["mimic"] = {"joint": mimic.get("joint")}
            row["mimic"] |= {key: float(mimic.get(key)) for key in ("multiplier", "offset")}
        config["frames"].append(row)
    config["tip_position"], config["tip_rpy"] = origin[-1]
    return config


LIMITS = {"lower": "lower", "upper": "upper", "speed": "velocity"}


def samples(robot, config, random):
    model = pinocchio.buildModelFromXML(robot, mimic=True)
    data, tip = model.createData(), model.getFrameId("tip_link")
    assert model.nq == model.nv == len(config["joints"]), (model.nq, model.nv)
    # Pinocchio orders independent joints as in the chain.
    own = [joint["name"] for joint in config["joints"]]
    names = [name for name in model.names if name in own]
    assert names == own, names
    lower = np.array([joint["lower"] for joint in config["joints"]])
    upper = np.array([joint["upper"] for joint in config["joints"]])

    def pose(q):
        pinocchio.framesForwardKinematics(model, data, q)
        return data.oMf[tip].copy()

    for _ in range(CONFIGURATIONS):
        q = random.uniform(lower, upper)
        jacobian = pinocchio.computeFrameJacobian(model, data, q, tip, pinocchio.LOCAL_WORLD_ALIGNED)
        jacobian = jacobian.reshape(6, len(q))[:3]
        at = pose(q)
        for j, step in enumerate(1e-6 * np.eye(len(q))):
            slope = (pose(q + step).translation - pose(q - step).translation) / 2e-6
            assert np.allclose(jacobian[:, j], slope, atol=1e-8), (jacobian[:, j], slope)
        yield {
            "joints": q.tolist(),
            "position": at.translation.tolist(),
            "rotation": at.rotation.T.ravel().tolist(),
            "jacobian": jacobian.T.ravel().tolist(),
        }


def main(path):
    random, fingers = np.random.default_rng(1), {}
    for name, finger in FINGERS.items():
        robot = urdf(*finger)
        config = chain_config(robot)
        fingers[name] = {"config": config, "samples": list(samples(robot, config, random))}
    with open(path, "w") as file:
        # One sample per line.
        content = json.dumps(fingers, separators=(",", ":"))
        file.write(content.replace('{"joints":[', '\n{"joints":[').replace('"samples"', '\n"samples"') + "\n")


if __name__ == "__main__":
    main(sys.argv[1])
