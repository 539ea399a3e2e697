"""Joins late: waits for a node, then reads its latched messages. Prints a line of JSON with description and frames."""

import sys
import time

from graph import late, say, session, tokens_of
from ros2_pyterfaces.cyclone.std_msgs.msg import String

opened = session(sys.argv[1])
tokens = []
while not all(any(f"/%{topic}/" in token for token in tokens) for topic in ("robot_description", "tf_static")):
    time.sleep(0.1)
    tokens = tokens_of(opened)
description = String.deserialize(late(opened, tokens, "robot_description"))
# pyzeros has no type for this message, but its bytes contain the frame names as plain text.
still = late(opened, tokens, "tf_static").decode("latin-1")
say(description=description.data[:60], frames=still)
opened.close()
