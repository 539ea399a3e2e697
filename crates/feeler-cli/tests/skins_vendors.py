"""Reads an emulated skin with its vendor's package and prints the mean of each taxel's readings as JSON.

Usage: skins_vendors.py anyskin|reskin|flexitac PORT
"""

import contextlib
import json
import sys

import numpy as np

SAMPLES = 50
CHIPS = 5


def magnetometers(package, port):
    """Mean temperature, x, y and z of each chip."""
    if package == "anyskin":
        from anyskin import AnySkinBase as Sensor
    else:
        from reskin_sensor import ReSkinBase as Sensor
    # The packages print to standard output.
    with contextlib.redirect_stdout(sys.stderr):
        sensor = Sensor(num_mags=CHIPS, port=port, temp_filtered=False)
        samples = sensor.get_data(num_samples=SAMPLES)
        sensor.close()
    if package == "anyskin":
        rows = [sample[1:] for sample in samples]
    else:
        rows = [sample.data for sample in samples]
    return np.mean(rows, axis=0).reshape(CHIPS, 4)


def flexitac(port):
    """Mean pressure of each taxel, row by row."""
    from flexitac import FlexiTacSensor

    with FlexiTacSensor(port, rows=12, cols=32, baseline=0.0) as sensor:
        frames = [sensor.read().raw for _ in range(SAMPLES)]
    return np.mean(frames, axis=0)


package, port = sys.argv[1:]
means = flexitac(port) if package == "flexitac" else magnetometers(package, port)
print(json.dumps(means.tolist()))
