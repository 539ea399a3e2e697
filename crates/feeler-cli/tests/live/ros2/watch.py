"""Watches a node with pyzeros, an independent implementation of rmw_zenoh: tokens, topics, services. Prints a line of
JSON for each."""

import asyncio
import sys

import pyzeros
from graph import late, say, session, tokens_of
from pyzeros.utils import rmw_zenoh_gid
from ros2_pyterfaces.cyclone.rcl_interfaces.srv import ListParameters
from ros2_pyterfaces.cyclone.sensor_msgs.msg import JointState, PointCloud2
from ros2_pyterfaces.cyclone.geometry_msgs.msg import WrenchStamped
from ros2_pyterfaces.cyclone.std_msgs.msg import String
from ros2_pyterfaces.cyclone.std_srvs.srv import Trigger


async def first(type_, topic):
    sub = pyzeros.Sub(type_, topic)
    async for message in sub.listen():
        return message


async def watch(opened, calls):
    with pyzeros.auto_context(node="watcher", zenoh_session=opened) as node:
        # The node is complete when no new tokens appear.
        tokens, before = [], None
        while not tokens or tokens != before:
            before = tokens
            await asyncio.sleep(0.5)
            tokens = tokens_of(opened)
        say(tokens=tokens)

        beside = []
        raw = opened.declare_subscriber(
            "0/joint_states/**", lambda sample: beside.append(sample.attachment.to_bytes())
        )
        joints = await first(JointState, "/joint_states")
        while not beside:
            await asyncio.sleep(0.01)
        raw.undeclare()
        publisher = next(token for token in tokens if "/%joint_states/" in token)
        say(
            names=list(joints.name),
            position=list(joints.position),
            attachment=len(beside[0]),
            is_publishers=beside[0][17:] == rmw_zenoh_gid(publisher),
        )
        cloud = await first(PointCloud2, "/finger_0/taxels")
        wrench = await first(WrenchStamped, "/finger_1/wrench")
        say(points=cloud.width, bytes=len(cloud.data), frame=wrench.header.frame_id)

        # Published before this subscriber joined.
        description = await asyncio.to_thread(late, opened, tokens, "robot_description")
        say(description=String.deserialize(description).data[:60])

        listed = await node.create_client(ListParameters, "/feeler/list_parameters").call_async(ListParameters.Request())
        say(parameters=list(listed.result.names))
        for call in calls:
            answer = await node.create_client(Trigger, call).call_async(Trigger.Request())
            say(call=call, success=answer.success, message=answer.message)


opened = session(sys.argv[1])
try:
    asyncio.run(watch(opened, sys.argv[2:]))
finally:
    opened.close()
