"""Scene, closed forms and measures shared by all peers: a soft tip on a rigid plate.

The tip is a rubber cylinder of radius 9 mm with a spherical end of radius `RADIUS`, bonded to a rigid holder at the
height `RADIUS` above its lowest point. It touches a flat plate with friction `FRICTION`. The holder is position
controlled in all four runs:

* press: to each of `DEPTHS` in turn, 0.1 s of motion and 0.15 s of rest;
* shear: pressed to the last depth, then moved along x at `SHEAR_SPEED` for `SHEAR_TIME`;
* hold:  pressed, moved by `HOLD_AT`, then at rest for `HOLD_TIME`;
* twist: pressed, then turned about the normal at `TWIST_SPEED` for `TWIST_TIME`.

SI units, radians. Forces act on the plate by the tip.

Closed forms (K. L. Johnson, Contact Mechanics, 1985) are those of an elastic half-space under small strain: Hertz, eqs.
(4.22) to (4.24); Cattaneo and Mindlin, section 7.2; torsion without slip, eq. (3.111), and its limit, the moment of the
traction mu p(r). Those of an elastic foundation (Johnson, section 4.3), a bed of independent springs, are given too.
"""

import json
import math
import pathlib
import sys
import time

RADIUS = 0.010
YOUNG, POISSON = 2.0e5, 0.4
FRICTION = 0.8
DEPTHS = [0.25e-3, 0.5e-3, 0.75e-3, 1.0e-3]
MOVE, REST = 0.1, 0.15
SHEAR_SPEED, SHEAR_TIME = 2e-3, 1.5
HOLD_AT, HOLD_TIME = 0.3e-3, 1.0
TWIST_SPEED, TWIST_TIME = 0.5, 2.0
SAMPLE = 0.01
STEPS = [0.002, 0.001, 0.0005]
# For finite elements, which take seconds per simulated second.
COARSE_STEPS = [0.01, 0.005, 0.0025]

DEPTH = DEPTHS[-1]
SHEAR_MODULUS = YOUNG / (2 * (1 + POISSON))


def hertz_force(depth):
    return 4 / 3 * YOUNG / (1 - POISSON**2) * math.sqrt(RADIUS) * depth**1.5


def hertz_radius(depth):
    return math.sqrt(RADIUS * depth)


def shear_stiffness(depth=DEPTH):
    """Tangential stiffness without slip, 8 a G / (2 - nu)."""
    return 8 * hertz_radius(depth) * SHEAR_MODULUS / (2 - POISSON)


def mindlin_force(travel, load, radius):
    """Shear force at `travel` under the normal force `load`, with slip from the rim inward."""
    full = 3 * FRICTION * load * (2 - POISSON) / (16 * SHEAR_MODULUS * radius)
    return FRICTION * load * (1 - max(0.0, 1 - travel / full) ** 1.5)


def twist_stiffness(depth=DEPTH):
    """Moment per angle without slip, 16 G a^3 / 3."""
    return 16 / 3 * SHEAR_MODULUS * hertz_radius(depth) ** 3


def hertz_twist_limit(load, radius):
    return 3 * math.pi / 16 * FRICTION * load * radius


def foundation_twist_limit(load, radius):
    return 8 / 15 * FRICTION * load * radius


def press_depth(t):
    """Depth of the holder at time `t` of the pressing."""
    period = MOVE + REST
    index = min(int(t / period + 1e-9), len(DEPTHS) - 1)
    before = DEPTHS[index - 1] if index else 0.0
    return before + (DEPTHS[index] - before) * min((t - index * period) / MOVE, 1.0)


PRESS_TIME = len(DEPTHS) * (MOVE + REST)


def motion(run, t):
    """Depth, travel along x and turn of the holder at time `t` of `run`."""
    if run == "press":
        return press_depth(t), 0.0, 0.0
    after = max(0.0, t - PRESS_TIME)
    if run == "shear":
        return press_depth(t), SHEAR_SPEED * after, 0.0
    if run == "hold":
        return press_depth(t), min(SHEAR_SPEED * after, HOLD_AT), 0.0
    return press_depth(t), 0.0, TWIST_SPEED * after


DURATIONS = {"press": PRESS_TIME, "shear": PRESS_TIME + SHEAR_TIME,
             "hold": PRESS_TIME + HOLD_AT / SHEAR_SPEED + HOLD_TIME, "twist": PRESS_TIME + TWIST_TIME}


def record(peer, run, step):
    """Runs one motion. `peer(step)` returns an object with `advance(depth, travel, turn)`, one step, and `read()`,
    a dict with `load`, `elements` (or None), `shear`, `moment` and `radius` (or None)."""
    tip = peer(step)
    steps, every = round(DURATIONS[run] / step), round(SAMPLE / step)
    rows, spent = [], 0.0
    for n in range(1, steps + 1):
        depth, travel, turn = motion(run, n * step)
        start = time.process_time()
        tip.advance(depth, travel, turn)
        spent += time.process_time() - start
        if n % every == 0:
            rows.append({"time": n * step, "depth": depth, "travel": travel, "turn": turn, **tip.read()})
    return {"run": run, "step": step, "seconds_per_second": spent / DURATIONS[run], "rows": rows}


def main(name, version, peer, steps=STEPS):
    """Records all runs at all steps and writes them, after each step, to the file named by the first argument."""
    out = {"name": name, "version": version, "records": []}
    for step in steps:
        for run in DURATIONS:
            out["records"].append(record(peer, run, step))
            last = out["records"][-1]
            print(f"{name}: {run}, {step} s, {last['seconds_per_second']:.3f} s per s", file=sys.stderr, flush=True)
        pathlib.Path(sys.argv[1]).write_text(json.dumps(out))


def print_motions():
    for step in STEPS:
        for run, duration in DURATIONS.items():
            path = [motion(run, n * step) for n in range(1, round(duration / step) + 1)]
            print(json.dumps({"run": run, "step": step, "every": round(SAMPLE / step), "path": path}))


if __name__ == "__main__":
    print_motions()
