"""Watches the tactile readings of a rig and stops the hand if a finger grasps too hard.

    pip install eclipse-zenoh==1.10.2 mcap-ros2-support==0.6.0
    python examples/python/watch_forces.py cap-closing --stop-above 1.5
    python examples/python/watch_forces.py cap-closing --connect tls/10.0.0.5:7447 --certificates lab/10.0.0.6/order

Message definitions are read from the `feeler` program, so they match the rig's version. docs/link.md describes the messages.
"""

import argparse
import json
import struct
import subprocess
import threading
import time

import zenoh
from mcap.records import Schema
from mcap_ros2.decoder import DecoderFactory

PROTOCOL = 5  # supported version of the messages
NOBODY = 0xFFFFFFFF  # no element, no finger
PRINT_INTERVAL = 0.1  # s between two lines of one finger


def decoder(feeler, name):
    """Decoder of a CDR message type, by the definition that `feeler schema NAME` prints."""
    asked = subprocess.run([feeler, "schema", name], check=True, capture_output=True)
    schema = Schema(id=1, name=f"feeler_msgs/msg/{name}", encoding="ros2msg", data=asked.stdout)
    return DecoderFactory().decoder_for("cdr", schema)


def protocol_of(data):
    """Version of a message: the first number after the four bytes of encapsulation."""
    return int.from_bytes(data[4:8], "little")


def stop_message(sender):
    """A Stop in CDR: little endian, version, length of the text with its zero byte, text, and an id of 0 at a multiple
    of eight bytes. With id 0, all stops of this sender count as one until it is resumed."""
    text = sender.encode() + b"\0"
    text += bytes(-len(text) % 8)
    length = len(sender.encode()) + 1
    return struct.pack("<4sII", b"\0\1\0\0", PROTOCOL, length) + text + struct.pack("<Q", 0)


def configuration(arguments):
    """Connects as a client of the hand, which forwards the messages of other programs."""
    config = zenoh.Config()
    settings = {
        "mode": "client",
        "scouting/multicast/enabled": False,
        "connect/endpoints": [arguments.connect],
    }
    if arguments.certificates:
        tls, folder = "transport/link/tls", arguments.certificates
        settings |= {
            f"{tls}/root_ca_certificate": f"{folder}/ca.pem",
            f"{tls}/enable_mtls": True,
            f"{tls}/connect_certificate": f"{folder}/cert.pem",
            f"{tls}/connect_private_key": f"{folder}/key.pem",
        }
    for key, value in settings.items():
        config.insert_json5(key, json.dumps(value))
    return config


class Watcher:
    """Prints readings and stops the hand if a force is too large."""

    def __init__(self, session, arguments):
        self.limit, self.sender = arguments.stop_above, arguments.sender
        self.decode_update = decoder(arguments.feeler, "TactileUpdate")
        self.decode_heartbeat = decoder(arguments.feeler, "Heartbeat")
        self.stop = session.declare_publisher(f"feeler/{arguments.rig}/stop", priority=zenoh.Priority.REAL_TIME, express=True)
        self.lock = threading.Lock()
        self.programs, self.above, self.printed = set(), set(), {}

    def heartbeat(self, sample):
        data = sample.payload.to_bytes()
        if protocol_of(data) != PROTOCOL:
            print(f"expected messages of version {PROTOCOL}, got version {protocol_of(data)} from a program", flush=True)
            return
        program = self.decode_heartbeat(data)
        with self.lock:
            is_new = program.instance not in self.programs
            self.programs.add(program.instance)
        if is_new:
            of_finger = "" if program.finger == NOBODY else f" of finger {program.finger}"
            print(printable(f"found {program.program}{of_finger}, feeler {program.version}"), flush=True)

    def update(self, sample):
        data = sample.payload.to_bytes()
        if protocol_of(data) != PROTOCOL:
            return  # its heartbeat has been reported
        update = self.decode_update(data)
        with self.lock:
            self.guard(update)
            now = time.monotonic()
            if now - self.printed.get(update.finger, 0.0) >= PRINT_INTERVAL:
                self.printed[update.finger] = now
                print(line(update), flush=True)

    def guard(self, update):
        """Sends a stop for every excessive force, so that lost messages do not matter. The hand then stays stopped
        while this program runs. NaN counts as excessive."""
        if self.limit is None or update.grasp_force <= self.limit:
            self.above.discard(update.finger)
            return
        self.stop.put(stop_message(self.sender))
        if update.finger not in self.above:
            self.above.add(update.finger)
            print(f"{line(update)}: more than {self.limit} N, sent a stop to the hand", flush=True)


def printable(text):
    """Escapes control characters in texts of other programs."""
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)


def line(update):
    """One finger's reading as a line of text."""
    flags = [name for name in ("touch", "slip", "over") if getattr(update, name)]
    felt = f"{update.header.stamp:8.3f} s  finger {update.finger}  {update.grasp_force:7.4f} N  {' '.join(flags):15}"
    if update.largest_element == NOBODY:
        return felt.rstrip()
    force = update.forces[update.largest_element]
    return f"{felt} element {update.largest_element:2}: {force.x:7.4f} {force.y:7.4f} {force.z:7.4f} N"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("rig", help="name of the rig; by default, the name of its experiment")
    parser.add_argument("--connect", default="tcp/127.0.0.1:7447", help="the hand's endpoint [default: %(default)s]")
    parser.add_argument("--stop-above", type=float, metavar="N", help="grasp force of a finger that stops the hand, N")
    parser.add_argument("--certificates", metavar="DIR", help="folder of a certificate with the right order or watch")
    parser.add_argument("--from", dest="sender", default="watch_forces.py", help="sender of the stop [default: %(default)s]")
    parser.add_argument("--feeler", default="feeler", help="program that prints message definitions [default: %(default)s]")
    arguments = parser.parse_args()
    with zenoh.open(configuration(arguments)) as session:
        watcher = Watcher(session, arguments)
        key = f"feeler/{arguments.rig}"
        subscribers = [
            session.declare_subscriber(f"{key}/finger/*/tactile", watcher.update),
            session.declare_subscriber(f"{key}/heartbeat/**", watcher.heartbeat),
        ]
        print(f"watching {key}; Ctrl-C ends it", flush=True)
        try:
            threading.Event().wait()
        except KeyboardInterrupt:
            for subscriber in subscribers:
                subscriber.undeclare()


if __name__ == "__main__":
    main()
