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
    sums = [abs(row["elements"] / row["load"] - 1) for row in press + shear + hold + twist
            if row["elements"] is not None and row["load"] > 0.02]
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


def percent(value, digits=1):
    return "-" if value is None else f"{100 * value:+.{digits}f}".replace("-0.0", "0.0").replace("+0.0", "0.0")


def table(peers):
    columns = {"load0": "load at 0.25 mm", "load1": "0.5 mm", "load2": "0.75 mm", "load3": "1 mm", "radius": "radius",
               "shear_slope": "shear slope", "break": "shear limit", "hold": "held shear after 1 s",
               "twist_slope": "torsion slope", "torsion": "torsion limit"}
    print("|peer|step, ms|" + "|".join(columns.values()) + "|elements' sum, largest error|coarsest against finest step|s per s|")
    print("|---" * (len(columns) + 5) + "|")
    for peer in peers:
        steps = sorted({r["step"] for r in peer["records"]}, reverse=True)
        for step in steps:
            m = measures(peer, step)
            total = "-" if m["sum"] is None else f"{100 * m['sum']:.2g}"
            change = f"{100 * step_dependence(peer, steps):.2g}" if step == steps[0] else ""
            cells = [percent(m[c]) for c in columns] + [total, change, f"{m['cost']:.3g}"]
            print(f"|{peer['name']} {peer['version']}|{1e3 * step:g}|" + "|".join(cells) + "|")


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
        step = sorted({r["step"] for r in peer["records"]})[1]
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
