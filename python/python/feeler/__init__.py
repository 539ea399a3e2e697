"""Tri-axial tactile sensing and control: camera picture to forces to finger velocities, and a simulated rig.

SI units everywhere, angles in radians; frames and signs as in the documentation of each array.
"""

from __future__ import annotations

from feeler._core import __version__
from feeler._environments import register_once_imported
from feeler._settings import Value
from feeler.control import FingerSense, HandSense, Law, Plan, Session, Step, Task
from feeler.recordings import PHASES, Recording, read
from feeler.runs import Run, report, run
from feeler.sensing import Calibration, Felt, Fingertip, Layout, Thresholds, calibrate, locate, simulate_loads
from feeler.sweeps import Sweep, sweep

register_once_imported()

__all__ = [
    "PHASES",
    "Calibration",
    "Felt",
    "FingerSense",
    "Fingertip",
    "HandSense",
    "Law",
    "Layout",
    "Plan",
    "Recording",
    "Run",
    "Session",
    "Step",
    "Sweep",
    "Task",
    "Thresholds",
    "Value",
    "__version__",
    "calibrate",
    "locate",
    "read",
    "report",
    "run",
    "simulate_loads",
    "sweep",
]
