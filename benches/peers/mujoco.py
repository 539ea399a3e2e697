"""Compares the time per simulated second of MuJoCo's cap scene and feeler's, in the same run.

Usage: mujoco.py FEELER_TXT, the output of the bench `physics_of_mujocos_scene`. Both simulate the scene and the motion of
`crates/feeler-sim/tests/references/mujoco_cap.py`, 5 s of two fingertips of 41 elements that turn a cap. feeler's step is 1 ms;
MuJoCo requires 0.5 ms for a fair comparison.
"""

import pathlib
import re
import subprocess
import sys

UNITS = {"ns": 1e-3, "µs": 1.0, "us": 1.0, "ms": 1e3}
FEELER_STEP, MUJOCO_STEP, STEPS = 0.001, 0.0005, 5000


def main(path):
    line = re.search(r"^.*physics_of_mujocos_scene.*$", pathlib.Path(path).read_text(), re.M)[0]
    # Columns: fastest, slowest, median, mean.
    value, unit = re.findall(r"([0-9.]+) (ns|µs|us|ms)\b", line)[2]
    own_us = float(value) * UNITS[unit] / STEPS
    script = pathlib.Path(__file__).parents[2] / "crates/feeler-sim/tests/references/mujoco_cap.py"
    mean_us, median_us = map(float, subprocess.check_output([sys.executable, script, "--time"], text=True).split())
    own, theirs = own_us * 1e-3 / FEELER_STEP, median_us * 1e-3 / MUJOCO_STEP
    print(f"feeler  {own_us:8.2f} us per step of {1e3 * FEELER_STEP} ms, {own:8.2f} ms per simulated second")
    print(f"MuJoCo  {median_us:8.2f} us per step of {1e3 * MUJOCO_STEP} ms (mean {mean_us:.2f}), {theirs:8.2f} ms per simulated second")
    print(f"MuJoCo takes {theirs / own:.0f} times as long (medians)")


if __name__ == "__main__":
    main(sys.argv[1])
