"""Resident memory of a vector environment over many steps, measured after each tenth of them.

    python python/benches/memory.py [STEPS] [AUTORESET]

STEPS is the total over all environments, by default 10 million, about a day of simulated time with many episodes.
"""

from __future__ import annotations

import gc
import os
import sys
from pathlib import Path

from feeler.gym import TactileVectorEnv

COUNT = 256
PAGE = os.sysconf("SC_PAGE_SIZE")


def resident_mb() -> float:
    """Returns the resident memory of the process, MB (Linux)."""
    gc.collect()
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * PAGE / 1e6


def grown_mb(steps: int, autoreset_mode: str = "NextStep") -> float:
    """Returns the growth of memory between a tenth of ``steps`` and the end, MB."""
    envs = TactileVectorEnv(COUNT, "cap-closing", autoreset_mode=autoreset_mode, vary={"friction": "uniform(0.4,1.2)"})
    envs.reset(seed=1)
    held, ended = [], 0
    for _ in range(10):
        for _ in range(steps // (10 * COUNT)):
            _, _, terminated, truncated, _ = envs.step(envs.guide())
            ended += int((terminated | truncated).sum())
        held.append(resident_mb())
        print(f"{held[-1]:.1f} MB after {ended} episodes", flush=True)
    envs.close()
    return held[-1] - held[0]


if __name__ == "__main__":
    grown = grown_mb(int(sys.argv[1]) if len(sys.argv) > 1 else 10_000_000, *sys.argv[2:3])
    print(f"{grown:+.2f} MB after the first tenth")
