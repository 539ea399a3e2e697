"""Rewrites a recording with the MCAP project's Python packages, like tools that compress, sort, filter or merge.

    pip install mcap zstandard lz4
    python crates/feeler-lab/references/rewrite_recording.py runs/NAME/recording.mcap FOLDER

Writes FOLDER/NAME.mcap for each entry of WAYS, and a truncated and recovered copy. `tests/all/record/rewritten.rs`
reads all of them.
"""

import json
import struct
import sys
from pathlib import Path

from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer

# Topic of an additional channel without messages.
OTHER = "/foreign"


def copy(source, target, *, first="metadata", order=None, topics=None, twice=False, **options):
    """Copies `source`. Metadata and attachments precede the messages if `first` is "metadata", else follow them."""
    with open(source, "rb") as file:
        reader = make_reader(file)
        messages = list(reader.iter_messages())
        metadata, attachments = list(reader.iter_metadata()), list(reader.iter_attachments())
        profile = reader.get_header().profile
    if topics:
        messages = [m for m in messages if m[1].topic in topics]
    if order:
        messages.sort(key=order)
    with open(target, "wb") as file:
        writer = Writer(file, **options)
        writer.start(profile=profile, library="rewrite_recording.py")
        # Shifts the ids of all other channels.
        writer.register_channel(OTHER, "json", writer.register_schema(OTHER, "jsonschema", b"{}"))

        def beside():
            for _ in range(2 if twice else 1):
                for m in metadata:
                    writer.add_metadata(m.name, m.metadata)
                for a in attachments:
                    writer.add_attachment(a.create_time, a.log_time, a.name, a.media_type, a.data)

        if first == "metadata":
            beside()
        channels = {}
        for schema, channel, message in messages:
            if channel.id not in channels:
                known = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[channel.id] = writer.register_channel(channel.topic, channel.message_encoding, known, channel.metadata)
            writer.add_message(
                channels[channel.id], message.log_time, message.data, message.publish_time, message.sequence
            )
        if first != "metadata":
            beside()
        writer.finish()


def recover(source, target):
    """Truncates the file to two thirds and copies the readable records with the writer's default settings."""
    from mcap.exceptions import EndOfFile, McapError
    from mcap.records import Attachment, Channel, Message, Metadata, Schema
    from mcap.stream_reader import StreamReader

    cut = Path(target).with_suffix(".cut")
    data = Path(source).read_bytes()
    cut.write_bytes(data[: len(data) * 2 // 3])
    with open(cut, "rb") as file, open(target, "wb") as out:
        writer = Writer(out)
        writer.start(profile="ros2")
        schemas, channels = {0: 0}, {}
        try:
            for record in StreamReader(file).records:
                if isinstance(record, Schema):
                    schemas[record.id] = writer.register_schema(record.name, record.encoding, record.data)
                elif isinstance(record, Channel):
                    channels[record.id] = writer.register_channel(
                        record.topic, record.message_encoding, schemas[record.schema_id], record.metadata
                    )
                elif isinstance(record, Message):
                    writer.add_message(
                        channels[record.channel_id], record.log_time, record.data, record.publish_time, record.sequence
                    )
                elif isinstance(record, Metadata):
                    writer.add_metadata(record.name, record.metadata)
                elif isinstance(record, Attachment):
                    writer.add_attachment(
                        record.create_time, record.log_time, record.name, record.media_type, record.data
                    )
        except (EndOfFile, McapError, struct.error):
            pass
        writer.finish()


ZSTD, LZ4, NONE = CompressionType.ZSTD, CompressionType.LZ4, CompressionType.NONE

WAYS = {
    "zstd": {"compression": ZSTD},
    "lz4": {"compression": LZ4},
    "uncompressed": {"compression": NONE, "first": "messages"},
    "small-chunks": {"compression": ZSTD, "chunk_size": 2_000, "first": "messages"},
    "one-chunk": {"compression": LZ4, "chunk_size": 1 << 28, "first": "messages"},
    "unchunked": {"use_chunking": False, "first": "messages"},
    "merged-with-itself": {"twice": True, "first": "messages"},
    # Sorted by topic instead of time.
    "by-topic": {"compression": ZSTD, "order": lambda m: (m[1].topic, m[2].log_time), "first": "messages"},
    "backwards": {"order": lambda m: (-m[2].log_time, -m[1].id)},
    "filtered": {"topics": {"/task", "/finger/0/tactile", "/finger/0/flags"}, "first": "messages"},
}


def main(source, folder):
    for name, options in WAYS.items():
        copy(source, f"{folder}/{name}.mcap", **options)
    recover(source, f"{folder}/recovered.mcap")
    json.dump(sorted([*WAYS, "recovered"]), sys.stdout)


if __name__ == "__main__":
    main(*sys.argv[1:3])
