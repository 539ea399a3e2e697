"""Shows a run in Rerun: hand, cap and elements in 3-D, the forces on the elements as arrows, plots, pictures.

    pip install rerun-sdk==0.41.0
    python examples/python/view_in_rerun.py runs/NAME/recording.mcap
    python examples/python/view_in_rerun.py runs/NAME/recording.mcap --save run.rrd    # for `rerun run.rrd`

Rerun reads the recording itself; lenses make arrows of taxels, and lines of wrenches, grasp forces and torques.
docs/recordings.md says what the topics carry.
"""

import argparse
import re
import sys
from pathlib import Path

try:
    import numpy as np
    import pyarrow as pa
    import rerun as rr
    import rerun.blueprint as rrb
    from rerun.chunk import DeriveLens, McapReader, Selector
except ImportError as error:
    sys.exit(f"{error}: pip install rerun-sdk==0.41.0")

ARROW_LENGTH = 0.01  # m/N
TOUCHES, SLIPS, ELEMENT = 0x56B4E9FF, 0xD55E00FF, 0x999999FF  # RGBA; the first two of Okabe and Ito
AXIS_COLOURS = [0xD55E00FF, 0x009E73FF, 0x56B4E9FF]

# A point of /finger/N/taxels.
TAXEL = np.dtype(
    {
        "names": ["tip", "force", "slip", "valid"],
        "formats": ["3<f4", "3<f4", "u1", "u1"],
        "offsets": [0, 12, 24, 25],
        "itemsize": 28,
    }
)


def run_constants(path):
    """Run constants in the recording's metadata."""
    for chunk in McapReader(path, decoders=["metadata"], recover=True).stream():
        batch = chunk.to_record_batch()
        if "feeler.run" in batch.schema.names:
            (pairs,) = batch["feeler.run"][0].as_py()
            return {pair["first"]: pair["second"] for pair in pairs}
    raise ValueError("expected metadata of a feeler run")


def arrows(touch_force):
    """A lens that makes arrows of taxels, in their frame: one from the tip of each element that is pressed by more than
    `touch_force`, N, along the force on the finger by what it touches."""

    def pressed(data):
        """Pressed elements of one message. Unknown forces are NaN and compare as not pressed."""
        taxels = np.frombuffer(bytes(data), TAXEL)
        normals = taxels["tip"] / np.linalg.norm(taxels["tip"], axis=1, keepdims=True)
        compression = -np.sum(taxels["force"] * normals, axis=1)
        return taxels[compression > touch_force]

    def each(value, kind):
        """Selects `value` of the pressed elements of each message."""

        def lists(messages):
            return pa.array([value(pressed(data)).tolist() for data in messages.to_pylist()], pa.list_(kind))

        return Selector(".").pipe(lists).pipe(Selector(".[]"))

    vector = pa.list_(pa.field("item", pa.float32(), nullable=False), 3)

    def colour(taxels):
        return np.where(taxels["slip"], SLIPS, TOUCHES)

    return (
        DeriveLens("sensor_msgs.msg.PointCloud2:data")
        .to_component(rr.Arrows3D.descriptor_origins(), each(lambda taxels: taxels["tip"], vector))
        .to_component(rr.Arrows3D.descriptor_vectors(), each(lambda taxels: ARROW_LENGTH * taxels["force"], vector))
        .to_component(rr.Arrows3D.descriptor_colors(), each(colour, pa.uint32()))
    )


def lines():
    """Lenses that make numbers of messages, for plots."""
    wrench = DeriveLens("geometry_msgs.msg.WrenchStamped:message")
    return [
        wrench.to_scalars("wrench.force.x", "wrench.force.y", "wrench.force.z"),
        DeriveLens("feeler_msgs.msg.Flags:message").to_scalars("grasp_force"),
        DeriveLens("feeler_msgs.msg.TorqueSensor:message").to_scalars("torque"),
    ]


def blueprint(topics):
    """A 3-D view, and beside it a plot or a picture of each of the `topics` that has one."""
    fingers = sorted(int(topic.split("/")[2]) for topic in topics if re.fullmatch(r"/finger/\d+/taxels", topic))
    scene = rrb.Spatial3DView(
        name="Hand",
        defaults=[
            rr.Points3D.from_fields(radii=0.0007, colors=ELEMENT),
            rr.Arrows3D.from_fields(radii=0.0004),
            rr.Ellipsoids3D.from_fields(fill_mode="MajorWireframe"),
        ],
        eye_controls=rrb.EyeControls3D(position=(0.0, -0.09, 0.17), look_target=(0.0, 0.0, 0.1)),
    )
    plots = []
    if "/torque_sensor" in topics:
        plots.append(plot("Torque, N m", {"/torque_sensor": rr.SeriesLines(names="torque")}))
    grasp = {f"/finger/{finger}/flags": rr.SeriesLines(names=f"finger {finger}") for finger in fingers}
    plots.append(plot("Grasp force, N", grasp))
    for finger in fingers:
        axes = rr.SeriesLines(names=["x", "y", "z"], colors=np.array(AXIS_COLOURS, np.uint32))
        plots.append(plot(f"Force on finger {finger} in its dome's frame, N", {f"/finger/{finger}/wrench": axes}))
    pictures = [rrb.Spatial2DView(origin=topic, name=topic) for topic in sorted(topics) if topic.endswith("/image")]
    beside = [rrb.Vertical(*plots)] + ([rrb.Vertical(*pictures)] if pictures else [])
    return rrb.Blueprint(
        rrb.Horizontal(scene, *beside, column_shares=[3] + [2] * len(beside)),
        rrb.TimePanel(timeline="message_log_time", state="collapsed"),
        collapse_panels=True,
    )


def plot(name, series):
    """A plot of entities, each with the names of its lines."""
    return rrb.TimeSeriesView(name=name, contents=list(series), overrides=series)


def show(path, save):
    touch_force = float(run_constants(path)["touch_force_threshold"])
    # Stamps are durations since the run's start, not dates.
    reader = McapReader(path, timeline_type="duration_ns", recover=True)
    topics = {channel.topic for channel in reader.info().channels if channel.message_count}
    run = reader.stream().lenses([arrows(touch_force), *lines()], output_mode="forward_all")
    rr.init("feeler", spawn=save is None)
    if save:
        rr.save(save)
    rr.send_blueprint(blueprint(topics))
    rr.send_chunks(run)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("recording", type=Path, help="a run's recording.mcap")
    parser.add_argument("--save", type=Path, metavar="FILE.rrd", help="write the view to a file instead of showing it")
    arguments = parser.parse_args()
    if not arguments.recording.is_file():
        sys.exit(f"there is no file {arguments.recording}")
    try:
        show(arguments.recording, arguments.save)
    except (ValueError, KeyError, OSError) as error:
        sys.exit(f"{arguments.recording} cannot be shown: {error}")


if __name__ == "__main__":
    main()
