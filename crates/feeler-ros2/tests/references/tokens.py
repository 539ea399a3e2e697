"""Prints keys, liveliness tokens and source ids of pyzeros: `pip install pyzeros==0.1.0`."""

import zenoh
from pyzeros import node, pub, service_common, sub
from pyzeros.qos import QosProfile
from pyzeros.utils import rmw_zenoh_gid, ros_type_to_dds_type

HASH = "RIHS01_" + 64 * "a"
config = zenoh.Config()
config.insert_json5("scouting/multicast/enabled", "false")
config.insert_json5("listen/endpoints", "[]")
session = zenoh.open(config)


def identity(entity: int) -> dict:
    return {"session": session, "domain_id": 7, "_node_id": 0, "_zenoh_id": "87e60c99", "_entity_id": entity}


joints, trigger = (ros_type_to_dds_type(name) for name in ("sensor_msgs/msg/JointState", "std_srvs/srv/Trigger"))
best_effort = QosProfile.sensor_data()
latched = QosProfile(durability="transient_local", depth=1)
keep_all = QosProfile(history="keep_all")
usual = QosProfile(depth=42)
tokens = [
    node.token_keyexpr("feeler", namespace="/", **identity(0)),
    node.token_keyexpr("feeler", namespace="/lab/left", **identity(0)),
    pub.token_keyexpr("/joint_states", joints, HASH, latched, "feeler", namespace="/", **identity(1)),
    pub.token_keyexpr("finger_0/wrench", joints, HASH, keep_all, "feeler", namespace="/lab/left", **identity(2)),
    sub.token_keyexpr("/joint_states", joints, HASH, best_effort, "feeler", namespace="/lab", **identity(3)),
    sub.token_keyexpr("/joint_states", joints, HASH, usual, "feeler", namespace="/lab", **identity(4)),
    service_common.token_keyexpr("SS", "/stop", trigger, HASH, QosProfile.services(), "feeler", namespace="/", **identity(5)),
    service_common.token_keyexpr("SC", "/stop", trigger, HASH, QosProfile.services(), "feeler", namespace="/", **identity(6)),
]
for token in tokens:
    print(token, rmw_zenoh_gid(token).hex())
print(pub.publisher_keyexpr("/joint_states", joints, HASH, "/", 7))
print(pub.publisher_keyexpr("finger_0/wrench", joints, HASH, "/lab/left", 7))
session.close()
