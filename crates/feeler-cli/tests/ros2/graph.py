"""What the tests' Python peers have in common: a session that connects to the node under test."""

import json
import logging
import sys

import zenoh

# Messages that a peer does not look at are no news.
logging.disable(logging.WARNING)


def session(endpoint: str) -> zenoh.Session:
    config = zenoh.Config()
    config.insert_json5("mode", '"peer"')
    config.insert_json5("connect/endpoints", json.dumps([endpoint]))
    config.insert_json5("listen/endpoints", "[]")
    config.insert_json5("scouting/multicast/enabled", "false")
    config.insert_json5("timestamping/enabled", "true")
    return zenoh.open(config)


def say(**words) -> None:
    print(json.dumps(words))
    sys.stdout.flush()
