"""Trials per second on threads and on one and two Ray nodes of one processor each. Checks that all tables are equal.

python benches/sweep_nodes.py [TRIALS]
"""

from __future__ import annotations

import logging
import os
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import feeler
import ray
from ray.cluster_utils import Cluster

NODE = {"num_cpus": 1, "object_store_memory": 200_000_000}
MILLION = 1_000_000


def measure(name: str, out: Path, trials: int, **how: Any) -> bytes:
    """Runs a sweep, prints its speed and returns its table."""
    start = time.perf_counter()
    swept = feeler.sweep(
        "cap-closing",
        trials=trials,
        sensing="direct",
        vary={"friction": "uniform(0.3,1.2)"},
        out=out,
        **how,
    )
    rate = trials / (time.perf_counter() - start)
    load = os.getloadavg()[0]
    print(f"{name:16} {rate:6.1f} trials/s, 10^6 trials in {MILLION / rate / 3600:.1f} h; load {load:.1f}", flush=True)
    return swept.table_path.read_bytes()


def main() -> None:
    trials = int(sys.argv[1]) if len(sys.argv) > 1 else 4000
    print(f"{trials} trials; {os.cpu_count()} processors", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        tables = [
            measure("1 thread", Path(folder, "1-thread"), trials, jobs=1),
            measure("2 threads", Path(folder, "2-threads"), trials, jobs=2),
        ]
        cluster: Any = Cluster(initialize_head=True, head_node_args={**NODE, "include_dashboard": False})
        ray.init(address=cluster.address, logging_level=logging.WARNING)
        for nodes in (1, 2):
            # Start the worker processes first, because a long sweep reuses them.
            feeler.sweep("cap-closing", trials=2 * nodes, sensing="direct", out=Path(folder, f"warm-{nodes}"), engine="ray")
            tables.append(measure(f"Ray, {nodes} node(s)", Path(folder, f"ray-{nodes}"), trials, engine="ray"))
            if nodes == 1:
                cluster.add_node(**NODE)
                cluster.wait_for_nodes()
        ray.shutdown()
        cluster.shutdown()
    assert all(table == tables[0] for table in tables), "tables differ"


if __name__ == "__main__":
    main()
