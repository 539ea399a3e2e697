"""Tests an installed Python package: runs an experiment and compares its digest: smoke.py FOLDER DIGEST."""

import json
import sys
import time
from pathlib import Path

start = time.perf_counter()
import feeler  # noqa: E402

print(f"import: {1000 * (time.perf_counter() - start):.0f} ms")
out, expected = Path(sys.argv[1]), sys.argv[2]
run = feeler.run("cap-closing", sensing="direct", out=str(out))
assert run.torque.max() > 0
digest = json.loads((out / "summary.json").read_text())["digest"]
assert digest == expected, f"digest {digest} instead of {expected}"
print(f"feeler {feeler.__version__}: {digest}")
