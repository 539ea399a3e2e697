"""Common code of the tests' Python peers: a session that connects to the node under test."""

import json
import logging
import sys
import time

import zenoh
from zenoh.ext import HistoryConfig, declare_advanced_subscriber

# Messages that a peer ignores cause irrelevant warnings.
logging.disable(logging.WARNING)


def configured() -> zenoh.Config:
    config = zenoh.Config()
    config.insert_json5("listen/endpoints", "[]")
    config.insert_json5("scouting/multicast/enabled", "false")
    config.insert_json5("timestamping/enabled", "true")
    return config


def session(endpoint: str) -> zenoh.Session:
    config = configured()
    config.insert_json5("mode", '"peer"')
    config.insert_json5("connect/endpoints", json.dumps([endpoint]))
    return zenoh.open(config)


def tokens_of(opened: zenoh.Session) -> list[str]:
    """The liveliness tokens of all nodes except the watcher."""
    replies = opened.liveliness().get("@ros2_lv/**")
    tokens = [str(reply.ok.key_expr) for reply in replies if reply.ok]
    return sorted(token for token in tokens if "/watcher" not in token)


def late(opened: zenoh.Session, tokens: list[str], topic: str) -> bytes:
    """The message of `topic`, in domain 0 without a namespace, that was published before this session subscribed."""
    heard = []
    parts = next(token for token in tokens if f"/%{topic}/" in token).split("/")
    listening = declare_advanced_subscriber(
        opened,
        f"0/{topic}/{parts[-3]}/{parts[-2]}",
        lambda sample: heard.append(sample.payload.to_bytes()),
        history=HistoryConfig(detect_late_publishers=True),
    )
    while not heard:
        time.sleep(0.01)
    listening.undeclare()
    return heard[0]


def say(**words) -> None:
    print(json.dumps(words))
    sys.stdout.flush()
