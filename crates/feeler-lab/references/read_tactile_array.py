"""Reads a `feeler_msgs/TactileArray` with rosbags, from the definitions in `ros2/feeler_msgs`, and prints it as JSON.

    pip install rosbags==0.11.9
    python crates/feeler-lab/references/read_tactile_array.py MESSAGE.cdr

Also prints the message's bytes as rosbags encodes it again, in hexadecimal digits.
"""

import json
import sys
from pathlib import Path

import numpy as np
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

DEFINITIONS = Path(__file__).parents[3] / "ros2/feeler_msgs/msg"
NAME = "feeler_msgs/msg/TactileArray"


def plain(value):
    """Converts a decoded message to numbers, strings, lists and dicts. NaN becomes null."""
    if hasattr(value, "__msgtype__"):
        names = [name for name in value.__dataclass_fields__ if name != "__msgtype__" and not name.isupper()]
        return {name: plain(getattr(value, name)) for name in names}
    if isinstance(value, (list, tuple, np.ndarray)):
        return [plain(item) for item in value]
    if isinstance(value, (float, np.floating)):
        return None if np.isnan(value) else float(value)
    return value.item() if isinstance(value, np.generic) else value


store = get_typestore(Stores.ROS2_JAZZY)
for name in ["TactileChannel", "TactileArray", "TactileState"]:
    store.register(get_types_from_msg((DEFINITIONS / f"{name}.msg").read_text(), f"feeler_msgs/msg/{name}"))
message = store.deserialize_cdr(Path(sys.argv[1]).read_bytes(), NAME)
again = store.serialize_cdr(message, NAME)
print(json.dumps({"message": plain(message), "again": bytes(again).hex()}))
