#!/usr/bin/env python3
"""Measures what subtracting the mean over all taxels costs and gains on a magnetic skin.

    python3 docs/figures/common_mode.py [PROGRAM, default target/release/feeler]

Reads the runs of normal force in the folder `eflesh-force` in FEELER_DATA (default ../shared/data): readings of five
three-axis magnetometers, µT, and of a scale. Calibrates on each run, without and with `common_mode`, and estimates the
other run, also with a uniform field of 50 µT added in the second half along x, y and z of the skin. Prints the RMSE (N) of
the second half without the field, and the root mean square of the change by the field (N), largest over its directions.
Deterministic; needs only Python; takes a minute."""

import csv
import gzip
import math
import os
import subprocess
import sys
import tempfile

PROGRAM = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else "target/release/feeler")
DATA = os.path.abspath(os.path.join(os.environ.get("FEELER_DATA", "../shared/data"), "eflesh-force"))
TURNS = [-90, -90, 180, 90, 0]  # of the chips, degrees
FIELD = 50.0  # µT
AXES = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}


def feeler(folder, *arguments):
    subprocess.run([PROGRAM, *arguments], cwd=folder, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def table(name):
    with gzip.open(os.path.join(DATA, f"{name}.csv.gz"), "rt") as file:
        return [[float(cell) for cell in row] for row in csv.reader(file)]


def layout(folder, common_mode):
    text = subprocess.run([PROGRAM, "list", "--taxels", "eflesh"], check=True, capture_output=True, text=True).stdout
    lines = [line for line in text.splitlines() if not line.startswith(("zero =", "columns ="))]
    names = '"m{n}_x", "m{n}_y", "m{n}_z"'
    columns = (
        'columns = { x = "m{n}_x", y = "m{n}_y", z = "m{n}_z", time = { column = "t", unit = "s" }, '
        f'without_header = ["t", {names}] }}'
    )
    place = next(index for index, line in enumerate(lines) if line.startswith("unit"))
    lines[place:place] = [columns] + ["common_mode = true"] * common_mode
    with open(os.path.join(folder, "skin.toml"), "w") as file:
        file.write("\n".join(lines))


def add_field(rows, direction):
    """The readings with a uniform field in their second half, in the axes of each chip."""
    x, y, z = (FIELD * part for part in direction)
    result = [row[:] for row in rows]
    for row in result[len(rows) // 2 :]:
        for chip, turn in enumerate(TURNS):
            angle = math.radians(-turn)
            row[1 + 3 * chip] += math.cos(angle) * x - math.sin(angle) * y
            row[2 + 3 * chip] += math.sin(angle) * x + math.cos(angle) * y
            row[3 + 3 * chip] += z
    return result


def estimate(folder, rows):
    """Normal forces of the second half, N; the validity is ignored."""
    with open(os.path.join(folder, "readings.csv"), "w", newline="") as file:
        csv.writer(file).writerows(rows)
    arguments = ["--taxels", "skin.toml", "--calibration", "wrench.toml", "-o", "out.csv", "--force"]
    feeler(folder, "sense", "readings.csv", *arguments)
    with open(os.path.join(folder, "out.csv")) as file:
        forces = [float(row["f_z"]) for row in csv.DictReader(file)]
    return forces[len(rows) // 2 :]


def root_mean_square(values):
    return math.sqrt(sum(value * value for value in values) / len(values))


def measure(folder, train, test, common_mode):
    layout(folder, common_mode)
    with open(os.path.join(folder, "FORCES.csv"), "w") as file:
        file.write("recording,time,f_z [gf]\n")
        for state in table(f"{train}-states"):
            if state[4] >= 0:
                file.write(f"{DATA}/{train}-sensor.csv.gz,{state[0]},{state[4]}\n")
    feeler(folder, "calibrate", "FORCES.csv", "--wrench", "--taxels", "skin.toml", "-o", "wrench.toml", "--force")
    rows, states = table(f"{test}-sensor"), table(f"{test}-states")
    forces = estimate(folder, rows)
    measured = [state[4] * 9.80665e-3 for state in states[len(rows) // 2 :]]
    pairs = [(a, b) for a, b in zip(forces, measured) if b >= 0]
    changes = {}
    for axis, direction in AXES.items():
        with_field = estimate(folder, add_field(rows, direction))
        changes[axis] = root_mean_square([a - b for a, b in zip(with_field, forces)])
    return root_mean_square([a - b for a, b in pairs]), changes


print("trained on, common mode, RMSE (N), change by 50 uT along x, y, z (N)")
for train, test in [("normal-1", "normal-2"), ("normal-2", "normal-1")]:
    for common_mode in [False, True]:
        with tempfile.TemporaryDirectory() as folder:
            error, changes = measure(folder, train, test, common_mode)
        shown = ", ".join(f"{changes[axis]:.3f}" for axis in AXES)
        print(f"{train}, {'on' if common_mode else 'off'}, {error:.3f}, {shown}", flush=True)
