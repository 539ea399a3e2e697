"""Compares recorded runs of the soft tip with the closed forms: a Markdown table on standard output, and a figure.

Usage: table.py FIGURE.svg RECORDS.json... Needs matplotlib.
"""

import json
import pathlib
import sys

import matplotlib
import numpy as np

import scene

matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402

# The same file from the same records.
matplotlib.rcParams.update({"svg.hashsalt": "feeler", "svg.fonttype": "none", "font.family": "sans-serif", "font.size": 9})
PERIOD = scene.MOVE + scene.REST
LOAD, RADIUS = scene.hertz_force(scene.DEPTH), scene.hertz_radius(scene.DEPTH)


def rows(peer, run, step):
    return next(r["rows"] for r in peer["records"] if r["run"] == run and r["step"] == step)


def at(samples, time):
    return min(samples, key=lambda row: abs(row["time"] - time))


def loads(samples):
    """Loads at rest at each depth."""
    return np.array([at(samples, (n + 1) * PERIOD)["load"] for n in range(len(scene.DEPTHS))])


def moving(samples):
    return [row for row in samples if row["time"] > scene.PRESS_TIME + 1e-9]


def slope(samples, by, of, until):
    """Least-squares slope through the first sample, for values of `by` up to `until`."""
    first = at(samples, scene.PRESS_TIME)
    part = [row for row in moving(samples) if row[by] <= until]
    x = np.array([row[by] for row in part])
    y = np.array([row[of] - first[of] for row in part])
    return float(x @ y / (x @ x))


def measures(peer, step):
    press, shear, hold, twist = (rows(peer, run, step) for run in ("press", "shear", "hold", "twist"))
    force = loads(press)
    out = {f"load{n}": f / scene.hertz_force(d) - 1 for n, (f, d) in enumerate(zip(force, scene.DEPTHS))}
    at_rest = at(press, scene.PRESS_TIME)
    sums = [abs(row["elements"] / row["load"] - 1) for row in shear + hold + twist
            if row["elements"] is not None and row["time"] >= scene.PRESS_TIME]
    out["sum"] = max(sums) if sums else None
    out["radius"] = at_rest["radius"] / RADIUS - 1 if at_rest["radius"] else None
    mindlin = [{**row, "shear": scene.mindlin_force(row["travel"], LOAD, RADIUS)} for row in shear]
    out["shear_slope"] = slope(shear, "travel", "shear", 1e-4) / slope(mindlin, "travel", "shear", 1e-4) - 1
    last = [row for row in shear if row["travel"] > 2.5e-3]
    out["break"] = float(np.mean([row["shear"] / row["load"] for row in last])) / scene.FRICTION - 1
    out["overshoot"] = max(row["shear"] / row["load"] for row in moving(shear)) / scene.FRICTION - 1
    held = [row for row in hold if row["time"] > scene.PRESS_TIME + scene.HOLD_AT / scene.SHEAR_SPEED + 0.015]
    out["hold"] = held[-1]["shear"] / held[0]["shear"] - 1
    out["twist_slope"] = slope(twist, "turn", "moment", 0.02) / scene.twist_stiffness() - 1
    last = [row for row in twist if row["turn"] > 0.8]
    out["torsion"] = float(np.mean([row["moment"] / row["load"] for row in last])) * LOAD / scene.hertz_twist_limit(LOAD, RADIUS) - 1
    out["cost"] = float(np.median([r["seconds_per_second"] for r in peer["records"] if r["step"] == step]))
    return out


def step_dependence(peer, steps):
    """Largest difference of load, shear and moment between the coarsest and the finest step, relative to Hertz's load, to
    mu N and to the limit of torsion."""
    worst = 0.0
    scales = {"load": LOAD, "shear": scene.FRICTION * LOAD, "moment": scene.hertz_twist_limit(LOAD, RADIUS)}
    for run in scene.DURATIONS:
        for coarse, fine in zip(rows(peer, run, steps[0]), rows(peer, run, steps[-1])):
            settled = run != "press" or (coarse["time"] + 1e-9) % PERIOD > scene.MOVE + 0.1
            if settled and coarse["time"] >= scene.PRESS_TIME * (run != "press"):
                worst = max(worst, *(abs(coarse[k] - fine[k]) / scale for k, scale in scales.items()))
    return worst


ROWS = {
    "load0": "load at 0.25 mm", "load1": "load at 0.5 mm", "load2": "load at 0.75 mm", "load3": "load at 1 mm",
    "radius": "contact radius at 1 mm", "shear_slope": "shear slope, first 0.1 mm", "break": "shear limit",
    "overshoot": "largest shear", "hold": "held shear, change in 1 s", "twist_slope": "torsion slope, first 0.02 rad",
    "torsion": "torsion limit",
}


def percent(value):
    return "-" if value is None else f"{100 * value:+.1f}".replace("-0.0", "0.0").replace("+0.0", "0.0")


def steps_of(peer):
    return sorted({r["step"] for r in peer["records"]}, reverse=True)


def middle(steps):
    return steps[len(steps) // 2]


def table(peers):
    """One column per peer, at the middle step; all values but the last two rows are differences in percent."""
    steps = [steps_of(peer) for peer in peers]
    found = [measures(peer, middle(own)) for peer, own in zip(peers, steps)]
    line = lambda name, cells: print(f"|{name}|" + "|".join(cells) + "|")
    line("", [f"{peer['name']} {peer['version']}" for peer in peers])
    line("---", ["---"] * len(peers))
    for key, name in ROWS.items():
        line(name, [percent(m[key]) for m in found])
    line("sum of the elements against the load, at 1 mm", ["-" if m["sum"] is None else f"{100 * m['sum']:.1g}" for m in found])
    line("largest change with the step",
         [f"{100 * step_dependence(p, own):.2g}" if len(own) > 1 else "-" for p, own in zip(peers, steps)])
    line("steps, ms", [", ".join(f"{1e3 * step:g}" for step in own) for own in steps])
    line("processor time, s per s", [f"{m['cost']:.2g}" for m in found])


def draw(path, peers):
    figure, (press, shear, twist) = plt.subplots(1, 3, figsize=(10, 3.2), constrained_layout=True)
    depth, travel = np.linspace(0, scene.DEPTH, 50), np.linspace(0, 3e-3, 100)
    press.plot(1e3 * depth, [scene.hertz_force(d) for d in depth], "k", label="closed form", lw=2)
    shear.plot(1e3 * travel, [scene.mindlin_force(x, LOAD, RADIUS) / scene.FRICTION / LOAD for x in travel], "k", lw=2)
    twist.axhline(1, color="k", lw=2)
    limit = scene.hertz_twist_limit(LOAD, RADIUS)
    turns = np.linspace(0, limit / scene.twist_stiffness() / 1.5, 2)
    twist.plot(turns, scene.twist_stiffness() * turns / limit, "k", lw=2)
    for peer in peers:
        step = middle(steps_of(peer))
        line, = press.plot([1e3 * d for d in scene.DEPTHS], loads(rows(peer, "press", step)), "o--", ms=3, lw=0.8, label=peer["name"])
        for axes, run, by, of, x, y in ((shear, "shear", "travel", "shear", 1e3, 1 / scene.FRICTION / LOAD),
                                        (twist, "twist", "turn", "moment", 1, 1 / limit)):
            part = moving(rows(peer, run, step))
            axes.plot([x * row[by] for row in part], [y * row[of] for row in part], color=line.get_color(), lw=0.9)
    press.set(xlabel="depth, mm", ylabel="load, N")
    shear.set(xlabel="travel, mm", ylabel="shear / (mu times Hertz's load)")
    twist.set(xlabel="turn, rad", ylabel="moment / Hertz's limit")
    figure.legend(loc="outside lower center", ncols=4, frameon=False)
    figure.savefig(path, metadata={"Date": None}, bbox_inches="tight", facecolor="white")


if __name__ == "__main__":
    found = [json.loads(pathlib.Path(path).read_text()) for path in sys.argv[2:]]
    table(found)
    draw(sys.argv[1], found)
