"""Common code of the simulated robots: orders on standard input, stamps, and clouds of forces."""

import math
import struct
import sys
import threading

from ros2_pyterfaces.cyclone.builtin_interfaces.msg import Time
from ros2_pyterfaces.cyclone.sensor_msgs.msg import PointCloud2, PointField
from ros2_pyterfaces.cyclone.std_msgs.msg import Header

FLOAT32 = 7
FIELDS = ["x", "y", "z", "fx", "fy", "fz"]


class Orders:
    """The latest order on standard input, such as `late 5`, read on a separate thread."""

    def __init__(self):
        self.what, self.late = "well", 0.0
        self.is_over = threading.Event()
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self):
        for line in sys.stdin:
            what, *late = line.split()
            self.what, self.late = what, float(late[0]) if late else 0.0
            if what == "end":
                self.is_over.set()


def stamp(seconds):
    whole = math.floor(seconds)
    return Time(sec=whole, nanosec=int((seconds - whole) * 1e9))


def force_cloud(elements, forces, now):
    """Cloud at the time `now` (s) of the `forces` (N) on `elements` at their positions (m), both in the fingertip frame."""
    data = b"".join(struct.pack("<6f", *tip, *force) for tip, force in zip(elements, forces))
    count = len(elements)
    return PointCloud2(
        header=Header(stamp=stamp(now), frame_id="fingertip"),
        height=1,
        width=count,
        fields=[PointField(name=name, offset=4 * i, datatype=FLOAT32, count=1) for i, name in enumerate(FIELDS)],
        is_bigendian=False,
        point_step=24,
        row_step=24 * count,
        data=list(data),
        is_dense=True,
    )
