"""Compares two tables of the same trials: measures that differ, and differences of means in standard errors.

Usage: trials_pair.py BASE/trials.csv OWN/trials.csv. Trials with the same number have the same random parameters and are compared
in pairs. By chance alone, one in 370 measures differs by more than three standard errors. The exit status is 1 if one differs by more
than four.
"""

import csv
import math
import statistics
import sys

SHOWN = 8
FEWEST_PAIRS = 30
BEYOND_CHANCE = 4.0


def rows(path):
    with open(path, encoding="utf-8") as file:
        return {row["trial"]: row for row in csv.DictReader(line for line in file if not line.startswith("#"))}


def numbers(base, own, name):
    for trial, row in base.items():
        try:
            pair = float(row[name]), float(own[trial][name])
        except (KeyError, ValueError):
            continue
        if all(map(math.isfinite, pair)):
            yield pair


def main(base_path, own_path):
    base, own = rows(base_path), rows(own_path)
    names = list(next(iter(base.values())))
    measures, same = [], 0
    for name in names[2:]:
        pairs = list(numbers(base, own, name))
        differences = [after - before for before, after in pairs]
        if len(pairs) < FEWEST_PAIRS or not any(differences):
            same += len(pairs) >= FEWEST_PAIRS
            continue
        error = statistics.stdev(differences) / math.sqrt(len(differences))
        mean = statistics.fmean(differences)
        reference = statistics.fmean(before for before, _ in pairs)
        measures.append((abs(mean) / error if error else math.inf, name, reference, mean, error))
    measures.sort(reverse=True)
    print(f"{len(base)} and {len(own)} trials; {same} measures are bit-identical, {len(measures)} are not")
    for off, name, reference, mean, error in measures[:SHOWN]:
        print(f"{off:5.1f} standard errors  {name}: {reference:.6g} {mean:+.2g} ± {error:.1g}")
    held = [name for name in names if name == "success" or name.startswith("claim.") and name.count(".") == 1]
    for name in held:
        counts = [sum(row[name] == "1" for row in table.values()) for table in (base, own)]
        if counts[0] != counts[1]:
            print(f"{name}: {counts[0]} of {len(base)} before, {counts[1]} of {len(own)} now")
    return int(any(off > BEYOND_CHANCE for off, *_ in measures))


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
