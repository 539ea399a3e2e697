"""Reads a recording with the MCAP project's Python packages and prints a summary as JSON.

    pip install mcap mcap-ros2-support
    python crates/feeler-record/references/read_recording.py runs/NAME/recording.mcap

`tests/all/mcap_tools.rs` compares the summary with feeler's own reader.
"""

import json
import sys

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory


def plain(value):
    """Converts a decoded message to numbers, strings, lists and dicts."""
    if hasattr(value, "__slots__"):
        return {name: plain(getattr(value, name)) for name in value.__slots__}
    if isinstance(value, (list, tuple, bytes, bytearray, memoryview)):
        return [plain(item) for item in value]
    return value


def main(path):
    with open(path, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        counts, last = {}, {}
        for _, channel, message, decoded in reader.iter_decoded_messages():
            counts[channel.topic] = counts.get(channel.topic, 0) + 1
            last[channel.topic] = {"log_time": message.log_time, **plain(decoded)}
        found = {
            "profile": reader.get_header().profile,
            "counts": counts,
            "last": last,
            "metadata": {m.name: m.metadata for m in reader.iter_metadata()},
            "attachments": {a.name: a.data.decode() for a in reader.iter_attachments()},
        }
    json.dump(found, sys.stdout)


if __name__ == "__main__":
    main(sys.argv[1])
