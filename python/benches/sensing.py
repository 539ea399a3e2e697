"""Time per frame of ``Fingertip.sense``, compared with Rust and with OpenCV's natural pipeline on the same frames.

    python python/benches/sensing.py [FRAMES]

Needs a clone, Rust and opencv-python-headless. As in a recording, the frames do not fit into the processor caches.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import feeler
import numpy as np

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "benches" / "peers"))
import opencv  # noqa: E402

CALIBRATION = ROOT / "crates" / "feeler-lab" / "experiments" / "reference-fingertip.calibration.toml"
ROUNDS = 7


def time_us(work: Callable[[], Any], frames: int) -> float:
    """Returns the time per frame, us, as the median of three runs."""
    times = []
    for _ in range(3):
        start = time.perf_counter()
        work()
        times.append(1e6 * (time.perf_counter() - start) / frames)
    return statistics.median(times)


def rust_example(name: str, *arguments: Path) -> str:
    """Returns the output of an example of the Rust crates."""
    command = ["cargo", "run", "--release", "--quiet", "-p", "feeler-lab", "--example", name, "--", *map(str, arguments)]
    return subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout


def main(count: int) -> None:
    """Interleaves the measurements, because the speed of the machine may vary, and prints medians."""
    pictures, _ = feeler.simulate_loads(loads=60)
    frames = np.resize(pictures, (count, *pictures.shape[1:]))
    tip = feeler.Fingertip.load(CALIBRATION)
    out = feeler.Felt.empty(count, tip.element_count)
    few, some = frames[:4], frames[: min(count, 50)]
    cv2.setNumThreads(1)

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        frames.tofile(folder / "frames.raw")
        rust_example("moments_speed", folder)  # writes the dewarping table
        natural = opencv.natural_pipeline(opencv.read_table(folder, frames.shape[1:]))
        rows = []
        for _ in range(ROUNDS):
            rust = float(rust_example("sense_frames", folder / "frames.raw", CALIBRATION))
            one = time_us(lambda: tip.sense(frames, threads=1, out=out), count)
            two = time_us(lambda: tip.sense(frames, threads=2, out=out), count)
            cached = time_us(lambda: [tip.sense(few, threads=1) for _ in range(100)], 100 * len(few))
            peer = time_us(lambda: [natural(frame) for frame in some], len(some))
            rows.append((rust, one, two, cached, peer, one / rust, one / two, peer / one))
    rust, one, two, cached, peer, to_rust, faster, longer = (statistics.median(column) for column in zip(*rows, strict=True))

    print(f"{count} frames of {frames.shape[2]}x{frames.shape[1]}, {frames.nbytes / 1e6:.0f} MB; OpenCV {cv2.__version__}")
    print(f"Rust, one thread               {rust:8.1f} us a frame")
    print(f"Fingertip.sense, one thread    {one:8.1f} us a frame, {to_rust:.2f} times Rust's")
    print(f"Fingertip.sense, two threads   {two:8.1f} us a frame, {faster:.2f} times as fast as one")
    print(f"Fingertip.sense, 4 frames      {cached:8.1f} us a frame, in the processor's cache, flags and new arrays included")
    print(f"OpenCV's natural pipeline      {peer:8.1f} us a frame, {longer:.0f} times as long")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 512)
