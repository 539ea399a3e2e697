"""Reads a recording with the libraries of viewers and prints a summary as JSON.

The libraries are rosbags, the MCAP project's ROS 2 decoder, and Rerun with `examples/python/view_in_rerun.py`.

    pip install mcap==1.6.0 mcap-ros2-support==0.6.0 rosbags==0.11.9 rerun-sdk==0.41.0
    python crates/feeler-lab/references/read_by_viewers.py runs/NAME/recording.mcap

`tests/all/record/viewers.rs` compares the summary with feeler's own reader. Poses are computed twice: from transforms,
and from the robot description and joint states.
"""

import dataclasses
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rerun.chunk import McapReader, RrdReader
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

EXAMPLE = Path(__file__).parents[3] / "examples/python/view_in_rerun.py"
SLIPS = 0xD55E00FF  # colour of the arrows of slipping elements in the example


def plain(value):
    """Converts a decoded message to numbers, strings, lists and dicts."""
    if dataclasses.is_dataclass(value):
        # Names in capitals are constants.
        names = [f.name for f in dataclasses.fields(value) if f.name != "__msgtype__" and not f.name.isupper()]
        return {name: plain(getattr(value, name)) for name in names}
    if hasattr(value, "__slots__"):
        return {name: plain(getattr(value, name)) for name in value.__slots__}
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, (list, tuple, bytes, bytearray, memoryview)):
        return [plain(item) for item in value]
    return value


def by_mcap(path):
    """Returns the message count of each topic from the file's summary, and log time and content of each message."""
    found = {}
    with open(path, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        summary = reader.get_summary()
        counts = summary.statistics.channel_message_counts
        written = {summary.channels[channel].topic: count for channel, count in counts.items() if count}
        for _, channel, message, decoded in reader.iter_decoded_messages():
            found.setdefault(channel.topic, []).append((message.log_time, decoded))
    return written, found


def by_rosbags(path):
    """Returns message counts, last messages, and standard types whose definition in the file differs from ROS 2's."""
    counts, last = {}, {}
    with AnyReader([Path(path)]) as reader:
        for connection, _, data in reader.messages():
            counts[connection.topic] = counts.get(connection.topic, 0) + 1
            last[connection.topic] = reader.deserialize(data, connection.msgtype)
        types = {c.msgtype for c in reader.connections if not c.msgtype.startswith("feeler_msgs")}
        ros = get_typestore(Stores.ROS2_JAZZY)
        differing = [t for t in types if reader.typestore.hash_rihs01(t) != ros.hash_rihs01(t)]
    return {"counts": counts, "last": plain_all(last), "standard_types": sorted(types), "differing_types": differing}


def plain_all(messages):
    return {topic: plain(message) for topic, message in messages.items()}


def matrix(position, quaternion):
    """Returns the homogeneous transform of a position and a quaternion x, y, z, w."""
    x, y, z, w = quaternion
    pose = np.eye(4)
    pose[:3, :3] = np.eye(3) + 2 * (w * cross(x, y, z) + cross(x, y, z) @ cross(x, y, z))
    pose[:3, 3] = position
    return pose


def cross(x, y, z):
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def about(axis, angle):
    """Returns the homogeneous transform of a rotation by `angle` about `axis`."""
    return matrix([0, 0, 0], [*(np.sin(angle / 2) * np.array(axis)), np.cos(angle / 2)])


def xyz(vector):
    return [vector.x, vector.y, vector.z]


def placed(frame, tree):
    """Returns the pose of a frame in the world. `tree` maps each frame to its parent and its pose in the parent."""
    pose = np.eye(4)
    while frame in tree:
        frame, in_parent = tree[frame]
        pose = in_parent @ pose
    assert frame == "world", f"expected the root frame world, got {frame}"
    return pose


def tree_of(transforms):
    """Returns the transform tree of `TransformStamped` messages."""
    in_parent = lambda t: matrix(xyz(t.translation), [*xyz(t.rotation), t.rotation.w])
    return {t.child_frame_id: (t.header.frame_id, in_parent(t.transform)) for t in transforms}


def tree_of_robot(robot, angles):
    """Returns the transform tree of a robot description at joint `angles`, without floating joints."""
    tree = {}
    for joint in robot.iter("joint"):
        if joint.get("type") == "floating":
            continue
        numbers = lambda tag, name: [float(x) for x in joint.find(tag).get(name).split()]
        roll, pitch, yaw = numbers("origin", "rpy")
        turned = about([0, 0, 1], yaw) @ about([0, 1, 0], pitch) @ about([1, 0, 0], roll)
        pose = matrix(numbers("origin", "xyz"), [0, 0, 0, 1]) @ turned
        if joint.get("type") == "revolute":
            pose = pose @ about(numbers("axis", "xyz"), angles[joint.get("name")])
        tree[joint.find("child").get("link")] = (joint.find("parent").get("link"), pose)
    return tree


def poses(messages):
    """Returns the world poses of the transform tree's leaves (column-major matrices) at each time with transforms."""
    fixed = [t for _, message in messages["/tf_static"] for t in message.transforms]
    robot = ElementTree.fromstring(messages["/robot_description"][0][1].data)
    angles = {time: dict(zip(m.name, m.position)) for time, m in messages["/joint_states"]}
    # Moving objects have separate messages with the same time.
    moved = {}
    for time, message in messages["/tf"]:
        moved.setdefault(time, []).extend(message.transforms)
    found, apart = [], 0.0
    for time, transforms in moved.items():
        tree = tree_of([*fixed, *transforms])
        ends = set(tree) - {parent for parent, _ in tree.values()}
        there = {frame: placed(frame, tree) for frame in ends}
        again = tree_of_robot(robot, angles[time])
        apart = max(apart, *(np.abs(placed(f, again) - pose).max() for f, pose in there.items() if f in again))
        found.append({"time": time, "poses": {frame: pose.T.ravel().tolist() for frame, pose in there.items()}})
    links = [link.get("name") for link in robot.iter("link")]
    return {"of_frames": found, "from_description_apart": apart, "frames": sorted(tree), "links": links}


def points(cloud):
    """Returns the points of a PointCloud2, decoded according to its field descriptions."""
    formats = {2: "u1", 7: "<f4"}
    return np.frombuffer(
        bytes(cloud.data),
        {
            "names": [f.name for f in cloud.fields],
            "formats": [formats[f.datatype] for f in cloud.fields],
            "offsets": [f.offset for f in cloud.fields],
            "itemsize": cloud.point_step,
        },
    )


def felt(messages, finger):
    """Returns the maximum difference between a finger's wrenches and the sums over its points, and its last points."""
    wrenches = {time: m.wrench for time, m in messages[f"/finger/{finger}/wrench"]}
    force_apart = torque_apart = largest = 0.0
    for time, cloud in messages[f"/finger/{finger}/taxels"]:
        cloud = points(cloud)
        tips, forces = (np.stack([cloud[n] for n in names], 1).astype(float) for names in (["x", "y", "z"], ["fx", "fy", "fz"]))
        forces = forces * cloud["valid"][:, None]
        off = lambda value, vector: np.abs(value.sum(0) - xyz(vector)).max()
        force_apart = max(force_apart, off(forces, wrenches[time].force))
        torque_apart = max(torque_apart, off(np.cross(tips, forces), wrenches[time].torque))
        largest = max(largest, np.linalg.norm(forces.sum(0)))
    last = {name: cloud[name].tolist() for name in cloud.dtype.names}
    return {"force_apart": force_apart, "torque_apart": torque_apart, "largest_force": largest, "last_points": last, "last_time": time}


def drawn_forces(messages, finger):
    """Returns the tips, vectors and slip flags of the arrows in the scene's lines, for each message."""
    found = []
    for _, message in messages["/scene"]:
        for marker in message.markers:
            if marker.ns == f"finger_{finger}_forces":
                start, end = (np.array([xyz(p) for p in marker.points[i::6]]).reshape(-1, 3) for i in (0, 1))
                slips = [c.r > c.b for c in marker.colors[::6]]
                found.append((start, end - start, slips))
    return found


def by_rerun(path, messages):
    """Returns the entities that Rerun's loader and the example create from the recording."""
    frames, shapes, moves, clouds = {}, {}, {}, {}
    for chunk in McapReader(path).stream():
        batch, entity = chunk.to_record_batch(), chunk.entity_path
        for name in batch.schema.names:
            rows = batch[name].to_pylist() if ":" in name else []
            if name == "CoordinateFrame:frame":
                frames[entity] = rows[-1][0]
            elif name.split(":")[-1] in ("radii", "lengths", "half_sizes") and "visual_geometries" in entity:
                shapes.setdefault(entity, {})[name] = rows[-1][0]
            elif name == "Points3D:positions":
                clouds.setdefault(entity, set()).update(len(row) for row in rows)
            elif name == "Transform3D:translation":
                turns = batch["Transform3D:quaternion"].to_pylist()
                for child, at, turned in zip(batch["Transform3D:child_frame"].to_pylist(), rows, turns):
                    moves.setdefault(child[0], []).append([*at[0], *turned[0]])
    spread = lambda numbers: np.ptp(np.array(numbers), axis=0)
    return {
        "shapes": {frames[entity]: shape for entity, shape in shapes.items()},
        "moves": {child: spread(rows)[:3].max() for child, rows in moves.items()},
        "turns": {child: spread(rows)[3:].max() for child, rows in moves.items()},
        "points": {entity: sorted(sizes) for entity, sizes in clouds.items()},
        "arrows": by_example(path, messages),
    }


def by_example(path, messages):
    """Compares the example's arrows of each finger with the lines of the scene."""
    rows = {}
    with tempfile.TemporaryDirectory() as folder:
        saved = Path(folder) / "run.rrd"
        subprocess.run([sys.executable, EXAMPLE, path, "--save", saved], check=True, stdout=sys.stderr)
        for chunk in RrdReader(saved).stream():
            batch = chunk.to_record_batch()
            if "Arrows3D:vectors" in batch.schema.names:
                columns = [batch[f"Arrows3D:{name}"].to_pylist() for name in ("origins", "vectors", "colors")]
                times = batch["message_log_time"].cast("int64").to_pylist()
                rows.setdefault(int(chunk.entity_path.split("/")[2]), []).extend(zip(times, *columns))
    found = {}
    for finger, arrows in rows.items():
        scene, apart = drawn_forces(messages, finger), 0.0
        for (_, *of_example, colours), (*of_scene, slips) in zip(sorted(arrows, key=lambda row: row[0]), scene, strict=True):
            assert [colour == SLIPS for colour in colours] == slips, "slipping arrows differ from the scene"
            for ours, theirs in zip(of_example, of_scene):
                apart = max(apart, np.abs(np.array(ours).reshape(-1, 3) - theirs).max(initial=0.0))
        found[finger] = {"count": sum(len(row[1]) for row in arrows), "from_scene_apart": apart}
    return found


def main(path):
    written, messages = by_mcap(path)
    fingers = sorted(int(topic.split("/")[2]) for topic in messages if topic.endswith("/taxels"))
    found = {
        "written": written,
        "rosbags": by_rosbags(path),
        "mcap_ros2": {
            "counts": {topic: len(all) for topic, all in messages.items()},
            "last": plain_all({topic: all[-1][1] for topic, all in messages.items()}),
        },
        "poses": poses(messages),
        "felt": [felt(messages, finger) for finger in fingers],
        "rerun": by_rerun(path, messages),
    }
    json.dump(found, sys.stdout, default=float)


if __name__ == "__main__":
    main(sys.argv[1])
