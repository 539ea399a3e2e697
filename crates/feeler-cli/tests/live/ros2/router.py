"""A Zenoh router like `rmw_zenohd`: sessions that connect to it discover each other."""

import sys
import threading

import zenoh
from graph import configured, say

config = configured()
config.insert_json5("mode", '"router"')
config.insert_json5("listen/endpoints", f'["{sys.argv[1]}"]')
opened = zenoh.open(config)
say(ready=True)
threading.Event().wait()
