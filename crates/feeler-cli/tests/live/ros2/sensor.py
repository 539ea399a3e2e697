"""Publishes messages of third-party sensors with pyzeros. Each line of the input is a message as JSON: its type, its
fields and its age (s)."""

import json
import sys
import time

import pyzeros
from graph import say, session
from ros2_pyterfaces.cyclone.builtin_interfaces.msg import Time
from ros2_pyterfaces.cyclone.geometry_msgs.msg import Vector3, Wrench, WrenchStamped
from ros2_pyterfaces.cyclone.sensor_msgs.msg import PointCloud2, PointField
from ros2_pyterfaces.cyclone.std_msgs.msg import Header


def header(late):
    now = time.time_ns() - round(late * 1e9)
    return Header(stamp=Time(sec=now // 10**9, nanosec=now % 10**9), frame_id="fingertip")


def vector(values):
    return Vector3(**dict(zip("xyz", map(float, values))))


opened = session(sys.argv[1])
with pyzeros.auto_context(node="sensor", zenoh_session=opened):
    wrenches = pyzeros.Pub(WrenchStamped, "/wrench", scope=None)
    clouds = pyzeros.Pub(PointCloud2, "/cloud", scope=None)
    say(ready=True)
    for line in sys.stdin:
        told = json.loads(line)
        if "force" in told:
            wrench = Wrench(force=vector(told["force"]), torque=vector([0.0] * 3))
            wrenches.publish(WrenchStamped(header=header(told["late"]), wrench=wrench))
        else:
            cloud = told["cloud"]
            cloud["fields"] = [PointField(**field) for field in cloud["fields"]]
            clouds.publish(PointCloud2(**(cloud | {"header": header(told["late"])})))
opened.close()
