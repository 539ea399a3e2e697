"""Reads a folder of exported tables with PyArrow, pandas and Polars; prints what they find as JSON."""

import json
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import polars as pl
import pyarrow.parquet as pq

folder = Path(sys.argv[1])
file = folder / "one.parquet"
table = pq.read_table(file)
frame = pd.read_parquet(file)
# One array of rows, elements and axes, as a user would make it.
forces = np.stack([np.stack(frame[f"finger_1_force_{axis}"]) for axis in "xyz"], axis=-1)
both = pl.read_parquet(folder / "*.parquet")
pressed = both.select(pl.col("finger_1_force_z").list.sum())["finger_1_force_z"].to_list()

print(
    json.dumps(
        {
            "types": {field.name: str(field.type) for field in table.schema},
            "columns": json.loads(table.schema.metadata[b"feeler.columns"]),
            "digest": table.schema.metadata[b"feeler.digest"].decode(),
            "timestamp": frame["timestamp"].tolist(),
            "phase": frame["phase"].tolist(),
            "slip": frame["finger_0_slip"].tolist(),
            "action": np.stack(frame["finger_0_command_joint_velocity"]).tolist(),
            "forces": forces.tolist(),
            "runs": both["run"].unique(maintain_order=True).to_list(),
            "rows": both.height,
            "pressed": pressed,
        }
    )
)
