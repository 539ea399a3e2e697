"""Watches a node in domain 7 with pyzeros, and prints lines of JSON: its tokens, stamped messages of its topics, and
the responses of its parameter services. Also reports messages in the default domain."""

import asyncio
import sys
import time

import pyzeros
from graph import say, session, tokens_of
from ros2_pyterfaces.cyclone.geometry_msgs.msg import WrenchStamped
from ros2_pyterfaces.cyclone.rcl_interfaces.msg import Parameter, ParameterValue
from ros2_pyterfaces.cyclone.rcl_interfaces.srv import (
    DescribeParameters,
    GetParameters,
    GetParameterTypes,
    ListParameters,
    SetParameters,
    SetParametersAtomically,
)
from ros2_pyterfaces.cyclone.rosgraph_msgs.msg import Clock
from ros2_pyterfaces.cyclone.sensor_msgs.msg import JointState

DOMAIN = 7
COUNT = 30
NAMES = ["control.slip_threshold", "control.law", "task.screw.strokes", "use_sim_time", "missing"]


def ns(stamp):
    return stamp.sec * 10**9 + stamp.nanosec


async def some(type_, topic, of):
    """The values `of(message)` of `COUNT` messages, each with its arrival time (s since 1970)."""
    sub = pyzeros.Sub(type_, topic)
    said = []
    async for message in sub.listen():
        said.append([of(message), time.time()])
        if len(said) == COUNT:
            return said


async def parameters(node):
    def client(type_, name):
        return node.create_client(type_, f"/lab/hand/{name}")

    listed = await client(ListParameters, "list_parameters").call_async(
        ListParameters.Request(prefixes=["control"], depth=1)
    )
    say(names=list(listed.result.names), prefixes=list(listed.result.prefixes))
    got = await client(GetParameters, "get_parameters").call_async(GetParameters.Request(names=NAMES))
    say(values=[[v.type, v.double_value, v.string_value, v.integer_value, v.bool_value] for v in got.values])
    types = await client(GetParameterTypes, "get_parameter_types").call_async(GetParameterTypes.Request(names=NAMES))
    say(types=list(types.types))
    described = await client(DescribeParameters, "describe_parameters").call_async(DescribeParameters.Request(names=NAMES))
    say(
        descriptors=[
            {
                "type": d.type,
                "description": d.description,
                "constraints": d.additional_constraints,
                "read_only": d.read_only,
                "floats": [[r.from_value, r.to_value] for r in d.floating_point_range],
                "integers": [[r.from_value, r.to_value] for r in d.integer_range],
            }
            for d in described.descriptors
        ]
    )
    wanted = [Parameter(name=name, value=ParameterValue(type=3, double_value=1.0)) for name in NAMES]
    told = await client(SetParameters, "set_parameters").call_async(SetParameters.Request(parameters=wanted))
    say(results=[[r.successful, r.reason] for r in told.results])
    told = await client(SetParametersAtomically, "set_parameters_atomically").call_async(
        SetParametersAtomically.Request(parameters=wanted)
    )
    say(results=[[told.result.successful, told.result.reason]])


async def watch(opened):
    elsewhere = []
    usual = opened.declare_subscriber("0/**", lambda sample: elsewhere.append(str(sample.key_expr)))
    with pyzeros.auto_context(node="watcher", zenoh_session=opened, domain_id=DOMAIN) as node:
        clock, joints, wrench = await asyncio.gather(
            some(Clock, "/clock", lambda m: ns(m.clock)),
            some(JointState, "/lab/joint_states", lambda m: [ns(m.header.stamp), list(m.position)]),
            some(WrenchStamped, "/lab/finger_0/wrench", lambda m: ns(m.header.stamp)),
        )
        say(tokens=tokens_of(opened))
        say(clock=clock, joints=joints, wrench=wrench, elsewhere=elsewhere)
        await parameters(node)
    usual.undeclare()


opened = session(sys.argv[1])
try:
    asyncio.run(watch(opened))
finally:
    opened.close()
