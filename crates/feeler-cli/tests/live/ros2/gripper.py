"""Simulates a parallel gripper of a ROS 2 graph with pyzeros: one joint that moves both jaws by the action
control_msgs/ParallelGripperCommand, a skin on each jaw, and an object between them that is lifted and put down.
Arguments: the endpoint to connect to, and the configuration as JSON. Lines on standard input select a fault:

well                  no fault
silent                no joint states are published
late SECONDS          stamps are SECONDS in the past, or in the future if negative
reject                goals are rejected
deaf                  goals are not answered
end                   the gripper ends and prints a summary of the goals
"""

import bisect
import json
import math
import random
import sys
import time
from dataclasses import dataclass, field

import pyzeros
from graph import say, session
from pyzeros.builtin_msgs import Attachment
from robots import Orders, force_cloud, stamp
from ros2_pyterfaces.cyclone.builtin_interfaces.msg import Time
from ros2_pyterfaces.cyclone.idl import IdlStruct, make_idl_service
from ros2_pyterfaces.cyclone.rosgraph_msgs.msg import Clock
from ros2_pyterfaces.cyclone.sensor_msgs.msg import JointState, PointCloud2
from ros2_pyterfaces.cyclone.std_msgs.msg import Header
from ros2_pyterfaces.cyclone.unique_identifier_msgs.msg import UUID

PERIOD = 0.01  # s of the gripper's time
ACTION = "control_msgs/action/ParallelGripperCommand_"
TOUCHING = 9  # elements of a skin on the object
STIFFNESS = 3000.0  # N/m of a skin on the object
LAG = 0.02  # s of the joint's position control
FRICTION = 0.5
LIFT = (0.6, 0.9)  # s after the grasp, start and end
DOWN = (2.0, 2.1)


@dataclass
class Goal(IdlStruct, typename=ACTION + "Goal"):
    command: JointState = field(default_factory=JointState)


@dataclass
class Request(IdlStruct, typename=ACTION + "SendGoal_Request"):
    goal_id: UUID = field(default_factory=UUID)
    goal: Goal = field(default_factory=Goal)


@dataclass
class Response(IdlStruct, typename=ACTION + "SendGoal_Response"):
    accepted: bool = False
    stamp: Time = field(default_factory=Time)


SendGoal = make_idl_service(Request, Response)

gripper = json.loads(sys.argv[2])
name, position = gripper["joint"], gripper["home"]
velocity = 0.0
goal = position
# Time of each goal (ns since 1970), and its command.
goals = []
ids = []
fresh = []
orders = Orders()


class Goals(pyzeros.Server):
    """Answers goals at once, on Zenoh's thread."""

    def input_data(self, responder):
        global goal
        command = responder.request.goal.command
        accepted = orders.what != "reject"
        if accepted:
            goal = command.position[0]
        goals.append((int(responder._request_attachment.source_timestamp), command))
        ids.append(bytes(responder.request.goal_id.uuid))
        if orders.what != "deaf":
            responder.send(Response(accepted=accepted, stamp=stamp(time.time())))
        return True


def move():
    """Moves the joint for a period. The object stops it at the maximum effort."""
    global position, velocity
    step = (goal - position) * (1.0 - math.exp(-PERIOD / LAG))
    step = max(-gripper["speed"] * PERIOD, min(gripper["speed"] * PERIOD, step))
    most = gripper["object"] + gripper["max_effort"] / STIFFNESS
    velocity = (min(position + step, most) - position) / PERIOD
    position += velocity * PERIOD


def load(since):
    """Weight that the fingers carry (N), `since` seconds after the grasp."""
    if since is None:
        return 0.0
    up = min(1.0, max(0.0, (since - LIFT[0]) / (LIFT[1] - LIFT[0])))
    down = min(1.0, max(0.0, (since - DOWN[0]) / (DOWN[1] - DOWN[0])))
    return gripper["weight"] * (up - down)


def forces(grip, shear):
    """Force on each element of a skin (N): pressed along the fingertip's axis, and sheared downward."""
    for index in range(len(gripper["elements"])):
        share = 1.0 / TOUCHING if index < TOUCHING else 0.0
        yield -share * grip + random.gauss(0.0, 1e-4), 0.0, -share * shear


def changes():
    """Time of each goal that differs from the previous one (ns since 1970)."""
    positions = [command.position[0] for _, command in goals]
    pairs = zip(goals[1:], positions, positions[1:])
    return [sent for (sent, _), before, after in pairs if before != after]


def most_age():
    """Maximum time from the latest valid joint states to a new goal (s of real time)."""
    ages = [0.0]
    for sent in changes():
        newest = bisect.bisect(fresh, sent)
        ages.append((sent - fresh[newest - 1]) * 1e-9 if newest else math.inf)
    return max(ages)


opened = session(sys.argv[1])
with pyzeros.auto_context(node="gripper", zenoh_session=opened):
    states = pyzeros.Pub(JointState, "/joint_states", scope=None)
    clock = pyzeros.Pub(Clock, "/clock", scope=None)
    skins = [pyzeros.Pub(PointCloud2, f"/jaw_{jaw}/forces", scope=None) for jaw in range(2)]
    # The first use compiles code, which takes longer than a goal may.
    Attachment.deserialize(b"\x00\x01\x00\x00" + bytes(16) + b"\x10" + bytes(16)).serialize()
    server = Goals(SendGoal, "/gripper_controller/gripper_cmd/_action/send_goal", scope=None)
    say(ready=True)
    now = 100.0 if gripper["sim_time"] else time.time()
    grasped, most_grip, least_margin, slipped = None, 0.0, math.inf, False
    while not orders.is_over.wait(PERIOD / gripper["speed_of_time"]):
        now = now + PERIOD if gripper["sim_time"] else time.time()
        move()
        grip = STIFFNESS * max(0.0, position - gripper["object"])
        most_grip = max(most_grip, grip)
        if grasped is None and grip > 0.5:
            grasped = now
        carried = load(None if grasped is None else now - grasped)
        slipped |= carried / 2.0 > FRICTION * grip + 1e-9
        shear = min(carried / 2.0, FRICTION * grip)
        what, stamped = orders.what, now - orders.late
        if gripper["sim_time"]:
            clock.publish(Clock(clock=stamp(now)))
        if what != "silent":
            if what != "late":
                fresh.append(time.time_ns())
            states.publish(
                JointState(
                    header=Header(stamp=stamp(stamped), frame_id=""),
                    name=["wrist", name],
                    position=[0.0, position],
                    velocity=[0.0, velocity],
                    effort=[],
                )
            )
        for skin in skins:
            skin.publish(force_cloud(gripper["elements"], forces(grip, shear), stamped))
    steps = [command.position[0] for _, command in goals]
    say(
        position=position,
        grasped=grasped is not None,
        slipped=slipped,
        most_grip=most_grip,
        goals=len(goals),
        unique=len(set(ids)),
        names=sorted({joint for _, command in goals for joint in command.name}),
        efforts=sorted({effort for _, command in goals for effort in command.effort}),
        range=[min(steps), max(steps)] if steps else None,
        most_age=most_age(),
    )
opened.close()
