"""A simulated robot of ros2_control by pyzeros: a joint_state_broadcaster and a forward_command_controller for velocities. A line on the
standard input ends it or makes its sensors silent."""

import sys
import threading
import time

import pyzeros
from pyzeros.sub import RawSub
from graph import say, session
from ros2_pyterfaces.cyclone.builtin_interfaces.msg import Time
from ros2_pyterfaces.cyclone.sensor_msgs.msg import JointState
from ros2_pyterfaces.cyclone.std_msgs.msg import Float64MultiArray, Header

# As broadcasters have them: in no order, and more than one asks for.
NAMES = ["wheel", "third", "first", "second"]
COMMANDED = ["first", "second", "third"]
PERIOD = 0.01

position = dict.fromkeys(NAMES, 0.0)
velocity = dict.fromkeys(NAMES, 0.0)
commands = []
orders = []


def take(sample):
    data = list(Float64MultiArray.deserialize(sample.payload.to_bytes()).data)
    commands.append(data)
    velocity.update(zip(COMMANDED, data))


def read_orders():
    for line in sys.stdin:
        orders.append(line.strip())


opened = session(sys.argv[1])
threading.Thread(target=read_orders, daemon=True).start()
with pyzeros.auto_context(node="robot", zenoh_session=opened) as node:
    states = pyzeros.Pub(JointState, "/joint_states", scope=None)
    listening = RawSub(Float64MultiArray, "/forward_velocity_controller/commands", take, scope=None)
    say(ready=True)
    while "end" not in orders:
        for name in NAMES:
            position[name] += velocity[name] * PERIOD
        if "silent" not in orders:
            now = time.time_ns()
            stamp = Time(sec=now // 10**9, nanosec=now % 10**9)
            states.publish(
                JointState(
                    header=Header(stamp=stamp, frame_id=""),
                    name=NAMES,
                    position=[position[name] for name in NAMES],
                    velocity=[velocity[name] for name in NAMES],
                    effort=[],
                )
            )
        time.sleep(PERIOD)
    say(position=[position[name] for name in COMMANDED], last=commands[-1])
opened.close()
