"""Simulates a ros2_control robot with pyzeros: a joint_state_broadcaster, a forward_command_controller for velocities,
and on request a fingertip whose elements are springs against a wall, and simulated time.
Arguments: the endpoint to connect to, and the configuration as JSON. Lines on standard input select a fault:

well                  no fault
silent                no joint states are published
late SECONDS          stamps are SECONDS in the past, or in the future if negative
numb                  no forces are published
nan                   forces are NaN
end                   the robot ends and prints a summary of its commands
"""

import bisect
import json
import math
import struct
import sys
import time

import pyzeros
from graph import say, session
from pyzeros.sub import RawSub
from robots import Orders, force_cloud, stamp
from ros2_pyterfaces.cyclone.rosgraph_msgs.msg import Clock
from ros2_pyterfaces.cyclone.sensor_msgs.msg import JointState, PointCloud2
from ros2_pyterfaces.cyclone.std_msgs.msg import Float64MultiArray, Header

PERIOD = 0.01  # s of the robot's time

robot = json.loads(sys.argv[2])
commanded = robot["joints"]
# Like real broadcasters: in another order, and with an additional joint.
names = ["wheel", *reversed(commanded)]
position = dict(zip(commanded, robot["home"])) | {"wheel": 0.0}
velocity = dict.fromkeys(names, 0.0)
commands = []
fresh = []
orders = Orders()


def take(sample):
    """Executes a command, and stores when it was sent (ns since 1970)."""
    data = list(Float64MultiArray.deserialize(sample.payload.to_bytes()).data)
    sent = struct.unpack_from("<q", sample.attachment.to_bytes(), 8)[0]
    commands.append((sent, data))
    velocity.update(zip(commanded, data))


def joint_states(now):
    return JointState(
        header=Header(stamp=stamp(now), frame_id=""),
        name=names,
        position=[position[name] for name in names],
        velocity=[velocity[name] for name in names],
        effort=[],
    )


def tips(finger):
    """x coordinates of the elements in the world frame (m). The finger's base is not rotated."""
    theta1, theta2, theta3 = (position[name] for name in commanded)
    l2, l3, l4 = finger["links"]
    c1, s1 = math.cos(theta1), math.sin(theta1)
    c2, c23, s23 = math.cos(theta2), math.cos(theta2 + theta3), math.sin(theta2 + theta3)
    centre = finger["base"][0] + c1 * (l2 + l3 * c2 + l4 * c23)
    row = (c1 * c23, -c1 * s23, s1)
    return [centre + sum(r * t for r, t in zip(row, tip)) for tip in finger["elements"]]


def forces(finger):
    """Force on each element of the fingertip (N), along its feeler."""
    for tip, x in zip(finger["elements"], tips(finger)):
        force = finger["stiffness"] * max(0.0, x - finger["wall"])
        force = math.nan if orders.what == "nan" else force
        length = math.sqrt(sum(t * t for t in tip))
        yield tuple(-force * t / length for t in tip)


def most_age():
    """Maximum time from the latest valid joint states to a command to move (s of real time)."""
    ages = [0.0]
    for sent, data in commands:
        if any(data):
            newest = bisect.bisect(fresh, sent)
            ages.append((sent - fresh[newest - 1]) * 1e-9 if newest else math.inf)
    return max(ages)


opened = session(sys.argv[1])
with pyzeros.auto_context(node="robot", zenoh_session=opened):
    states = pyzeros.Pub(JointState, "/joint_states", scope=None)
    clock = pyzeros.Pub(Clock, "/clock", scope=None)
    felt = pyzeros.Pub(PointCloud2, "/finger/forces", scope=None)
    listening = RawSub(Float64MultiArray, "/forward_velocity_controller/commands", take, scope=None)
    say(ready=True)
    now = 100.0 if robot["sim_time"] else time.time()
    while not orders.is_over.wait(PERIOD / robot["speed"]):
        before, now = now, now + PERIOD if robot["sim_time"] else time.time()
        for name in names:
            position[name] += velocity[name] * (now - before)
        what, stamped = orders.what, now - orders.late
        if robot["sim_time"]:
            clock.publish(Clock(clock=stamp(now)))
        if what != "silent":
            if what != "late":
                fresh.append(time.time_ns())
            states.publish(joint_states(stamped))
        if robot["finger"] and what != "numb":
            finger = robot["finger"]
            felt.publish(force_cloud(finger["elements"], forces(finger), stamped))
    # Commands that were sent before the end order may still arrive.
    hangs = time.time() + 400
    while commands and any(commands[-1][1]) and time.time() < hangs:
        time.sleep(PERIOD)
    say(
        position=[position[name] for name in commanded],
        last=commands[-1][1] if commands else None,
        moved=sum(any(data) for _, data in commands),
        most_age=most_age(),
    )
opened.close()
