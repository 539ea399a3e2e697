"""Comes late: waits until a node is there, and asks for what it said before. One line of JSON for what does not move."""

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
# pyzeros has no type for it: the names of the frames are in it as they are.
still = late(opened, tokens, "tf_static").decode("latin-1")
say(description=description.data[:60], frames=still)
opened.close()
