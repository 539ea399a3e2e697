#!/usr/bin/env python3
"""Makes the figures of docs/your-fingertip.md from recordings of real sensors, by `feeler` and ffmpeg.

    python3 docs/figures/real_data.py target/release/feeler ../shared/data

Needs matplotlib and Pillow. FEELER_FFMPEG names ffmpeg. Writes beside itself: gelsight-located.png, gelsight-tracks.svg,
gelsight-slip.svg (videos of Parag and Misimi, BSD-2: LICENSE-gelsight beside), eflesh-shear.svg (sequences of Bhirangi, Pattabiraman
et al., MIT).
"""

import csv
import gzip
import math
import os
import pathlib
import subprocess
import sys
import tempfile

import matplotlib
from PIL import Image

matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
FEELER, DATA = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
FFMPEG = os.environ.get("FEELER_FFMPEG", "ffmpeg")
RATE = 25  # frames/s of the videos
SETTLED = 12  # number of the first frame after the lamps have settled
OBJECT = "cheese_tube"
SURE = 0.5  # confidence from which on a marker is drawn
SEQUENCES = {"0": "dragged", "100": "held"}  # of eFlesh, and their labels

# The same files from the same data.
matplotlib.rcParams.update({"svg.hashsalt": "feeler", "svg.fonttype": "none", "font.family": "sans-serif", "font.size": 9})


def feeler(*arguments):
    """Runs feeler; what it prints."""
    return subprocess.run([FEELER, *map(str, arguments)], check=True, text=True, capture_output=True).stdout


def decode(video, *arguments):
    """Gray frames of a video as ffmpeg writes them."""
    command = [FFMPEG, "-nostdin", "-v", "error", "-i", video, *arguments, "-pix_fmt", "gray"]
    return subprocess.run([*command, "-"], check=True, capture_output=True).stdout


def save(figure, name):
    figure.savefig(HERE / name, metadata={"Date": None}, bbox_inches="tight", facecolor="white")
    plt.close(figure)


def located(folder):
    """The preview of the first frame, at twice its size."""
    frame = folder / "first.png"
    frame.write_bytes(decode(DATA / f"gelsight-slip/{OBJECT}-hold.avi", "-frames:v", "1", "-f", "image2pipe", "-c:v", "png"))
    preview = folder / "preview.png"
    feeler("locate", frame, "-o", folder / "first.toml", "--preview", preview)
    width, height = Image.open(frame).size
    image = Image.open(preview).resize((2 * width, 2 * height), Image.Resampling.LANCZOS)
    image.quantize(128).save(HERE / "gelsight-located.png", optimize=True)


def tracks(folder, outcome):
    """Frames of a video from the first settled one on, places in it, and displacements from it: by frame, by marker, px; not a number
    where the tracker is in doubt."""
    video = DATA / f"gelsight-slip/{OBJECT}-{outcome}.avi"
    after = ["-vf", f"select=gte(n\\,{SETTLED})"]
    reference = folder / f"{outcome}.png"
    reference.write_bytes(decode(video, *after, "-frames:v", "1", "-f", "image2pipe", "-c:v", "png"))
    layout, table = folder / f"{outcome}.toml", folder / f"{outcome}.csv"
    feeler("locate", reference, "-o", layout)
    width, height = Image.open(reference).size
    raw = decode(video, *after, "-f", "rawvideo")
    sense = [FEELER, "sense", "-", "--raw", f"{width}x{height}", "--rate", str(RATE), "--layout", layout, "--track", "-o", table]
    subprocess.run(sense, input=raw, check=True, capture_output=True)
    rows = {}
    for row in csv.DictReader(table.open()):
        sure = float(row["confidence"]) >= SURE
        rows.setdefault(int(row["frame"]), []).append((float(row["u_x"]), float(row["u_y"])) if sure else (math.nan, math.nan))
    places = [line.split("[")[1].rstrip("]\n").split(",") for line in layout.open() if line.startswith("centre_px")]
    places = [(float(x), float(y)) for x, y in places]
    frames = [Image.frombytes("L", (width, height), raw[i : i + width * height]) for i in range(0, len(raw), width * height)]
    return frames, places, [rows[frame] for frame in sorted(rows)]


def largest(displacements):
    """The largest of all that is known; not a number where little is."""
    lengths = [math.hypot(x, y) for x, y in displacements if not math.isnan(x)]
    return max(lengths) if 2 * len(lengths) > len(displacements) else math.nan


def draw_tracks(frames, places, rows):
    """The way of every marker to the last frame."""
    figure, axes = plt.subplots(figsize=(6.4, 4.8))
    axes.imshow(frames[-1], cmap="gray")
    for marker, (x, y) in enumerate(places):
        way = [row[marker] for row in rows]
        axes.plot([x + u for u, _ in way], [y + v for _, v in way], color="#ffb000", linewidth=0.7)
        axes.plot(x + way[-1][0], y + way[-1][1], "+", color="#ff3c28", markersize=6)
    axes.set_axis_off()
    save(figure, "gelsight-tracks.svg")


def draw_slip(rows):
    """Displacement of the marker that moved farthest, by time, of the object that was held and that was lost."""
    figure, axes = plt.subplots(figsize=(6.4, 2.6))
    for (outcome, frames), colour in zip(rows.items(), ("#1a66b0", "#c0392b")):
        axes.plot([(SETTLED + i) / RATE for i in range(len(frames))], list(map(largest, frames)), color=colour, label=outcome, linewidth=1)
    axes.set(xlabel="time, s", ylabel="largest displacement, px", xlim=(0, None), ylim=(0, None))
    axes.legend(frameon=False)
    save(figure, "gelsight-slip.svg")


def draw_shear(folder):
    """Shear of each magnetometer of eFlesh's left array, in a sequence that is dragged and one that is held."""
    unpacked, table = folder / "sequences.csv", folder / "eflesh.csv"
    unpacked.write_bytes(gzip.decompress((DATA / "eflesh-slip/sequences.csv.gz").read_bytes()))
    feeler("sense", unpacked, "--taxels", "eflesh", "--prefix", "left", "--sequence", "sequence", "-o", table)
    traces = {}
    for row in csv.DictReader(table.open()):
        shear = (float(row["f_x_counts"]) ** 2 + float(row["f_y_counts"]) ** 2) ** 0.5
        traces.setdefault(row["sequence"], {}).setdefault(row["element"], []).append(shear)
    figure, panels = plt.subplots(1, 2, figsize=(6.4, 2.6), sharey=True)
    for axes, (sequence, label) in zip(panels, SEQUENCES.items()):
        for element, trace in traces[sequence].items():
            axes.plot(trace, label=f"magnetometer {element}", linewidth=1)
        axes.set(title=f"sequence {sequence}: {label}", xlabel="sample", xlim=(0, None), ylim=(0, None))
    panels[0].set_ylabel("shear, counts")
    panels[1].legend(frameon=False, fontsize=7)
    save(figure, "eflesh-shear.svg")


with tempfile.TemporaryDirectory() as temporary:
    temporary = pathlib.Path(temporary)
    located(temporary)
    recorded = {outcome: tracks(temporary, outcome) for outcome in ("hold", "slip")}
    draw_tracks(*recorded["hold"])
    draw_slip({outcome: rows for outcome, (_, _, rows) in recorded.items()})
    draw_shear(temporary)
