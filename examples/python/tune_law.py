"""Searches the parameters of the control law `best` by CMA-ES: maximizes torque without exceeding the force of the defaults.

    pip install ./python cma==4.5.0
    python examples/python/tune_law.py

All candidates tighten the same caps, which vary in friction, seat, offset and noise as in `feeler compare`. The result is then
compared with the defaults on other caps. Ctrl-C ends the search with the best parameters so far.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import feeler
import numpy as np
from numpy.typing import NDArray

try:
    import cma
except ImportError as error:
    sys.exit(f"{error}: pip install cma==4.5.0")

Array = NDArray[Any]

# Variation and settings of `feeler compare cap-closing`.
CAPS = {
    "friction": "uniform(0.4,1.2)",
    "sim.object.cap.offset.0": "uniform(-0.001,0.001)",
    "sim.object.cap.offset.1": "uniform(-0.001,0.001)",
    "sim.object.cap.motion.thread.seat_angle": "relative(0.5,1.5)",
    "direct_sensing.normal_noise": "uniform(0,0.006)",
    "direct_sensing.shear_noise": "uniform(0,0.006)",
}
SETTINGS: dict[str, feeler.Value] = {"sim.variation.friction": 0.0, "sim.object.cap.offset": [0.0, 0.0, 0.0]}

# Parameters of the law: default, least and greatest value.
SEARCHED = {
    "margin": (3.0, 1.0, 10.0),
    "element_force": (0.47, 0.3, 0.505),
    "slip_share": (0.6, 0.0, 1.0),
    "gain": (0.16, 0.02, 0.31),
    "pressing_speed": (0.008, 0.001, 0.03),
}
DEFAULTS = {name: default for name, (default, _, _) in SEARCHED.items()}


def best(parameters: dict[str, float]) -> dict[str, feeler.Value]:
    """The settings that choose the law with these parameters."""
    return {f"control.law.best.{name}": value for name, value in parameters.items()}


def tighten(law: dict[str, feeler.Value], caps: int, seed: int) -> tuple[Array, Array]:
    """Final torque (mN·m) and peak force on an element (N) of each cap under a law."""
    settings = SETTINGS | law
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "sweep"
        sweep = feeler.sweep("cap-closing", trials=caps, vary=CAPS, settings=settings, sensing="direct", seed=seed, out=out)
        columns = sweep.columns()
    peaks = [columns[f"stroke{stroke}.peak_element_force"] for stroke in (1, 2, 3, 4)]
    return 1e3 * columns["cap_torque"], np.max(peaks, axis=0)


def parameters_at(place: Array) -> dict[str, float]:
    """The parameters at a place in the unit cube."""
    ranges = [(least, most) for _, least, most in SEARCHED.values()]
    values = [float(f"{least + share * (most - least):.4g}") for share, (least, most) in zip(place, ranges, strict=True)]
    return dict(zip(SEARCHED, values, strict=True))


def search(arguments: argparse.Namespace) -> dict[str, float]:
    """The best parameters found."""
    torque, peak = tighten(best(DEFAULTS), arguments.caps, arguments.seed)
    budget = peak.mean()
    found, most = dict(DEFAULTS), torque.mean()
    print(f"defaults: {most:.2f} mN·m, {budget:.4f} N on {arguments.caps} caps")
    start = [(default - least) / (most - least) for default, least, most in SEARCHED.values()]
    options = {"bounds": [0.0, 1.0], "seed": arguments.seed + 1, "popsize": arguments.population, "verbose": -9}
    strategy = cma.CMAEvolutionStrategy(start, 0.15, options)
    began = time.monotonic()
    try:
        for generation in range(1, arguments.generations + 1):
            places, costs = strategy.ask(), []
            for place in places:
                candidate = parameters_at(place)
                torque, peak = tighten(best(candidate), arguments.caps, arguments.seed)
                # Steeper than the rise of torque with force, so that the best are within the budget.
                score = torque.mean() - arguments.price * max(0.0, peak.mean() - budget)
                costs.append(-score)
                if score > most:
                    found, most = candidate, score
            strategy.tell(places, costs)
            print(f"{(time.monotonic() - began) / 60:5.1f} min, generation {generation}: {most:.2f} mN·m", flush=True)
    except KeyboardInterrupt:
        print("interrupted: the best so far")
    return found


def main() -> None:
    """Searches, then prints the table for the experiment file and the improvement."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=100, help="seed of the caps and of the search")
    parser.add_argument("--caps", type=int, default=64, help="caps tightened by each candidate")
    parser.add_argument("--population", type=int, default=8, help="candidates of a generation")
    parser.add_argument("--generations", type=int, default=12, help="number of generations")
    parser.add_argument("--price", type=float, default=300.0, help="penalty of peak force above that of the defaults, mN·m/N")
    parser.add_argument("--held-out", type=int, default=500, help="number of other caps for the comparison with the defaults")
    arguments = parser.parse_args()
    found = search(arguments)
    print("\n[control.law.best]")
    for name, value in found.items():
        print(f"{name} = {value}")
    (torque, peak), (own_torque, own_peak) = (
        tighten(best(p), arguments.held_out, arguments.seed + 1) for p in (DEFAULTS, found)
    )
    print(f"\non {arguments.held_out} other caps: {own_torque.mean():.2f} mN·m, {own_peak.mean():.4f} N; ", end="")
    print(f"defaults {torque.mean():.2f} mN·m, {peak.mean():.4f} N")
    for what, difference in (("mN·m", own_torque - torque), ("N", own_peak - peak)):
        error = 1.96 * difference.std(ddof=1) / np.sqrt(len(difference))
        print(f"cap by cap: {difference.mean():+.4f} ± {error:.4f} {what}")


if __name__ == "__main__":
    main()
