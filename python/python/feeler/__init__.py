"""Tri-axial tactile sensing and control: forces from camera images, finger velocities from forces, and a simulated rig.

All quantities are in SI units and angles in radians. The documentation of each array states its frame and signs.
"""

from __future__ import annotations

from feeler._core import __version__
from feeler._environments import register_once_imported
from feeler._settings import Value
from feeler.contacts import Contacts, contacts
from feeler.control import FingerSense, HandSense, Law, Plan, Session, Step, Task
from feeler.recordings import PHASES, Recording, read
from feeler.runs import Run, report, run
from feeler.sensing import Calibration, Felt, Fingertip, Layout, Thresholds, calibrate, locate, simulate_loads
from feeler.sweeps import Sweep, sweep
from feeler.wrenches import Wrenches, WrenchEstimator

register_once_imported()

__all__ = [
    "PHASES",
    "Calibration",
    "Contacts",
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
    "WrenchEstimator",
    "Wrenches",
    "__version__",
    "calibrate",
    "contacts",
    "locate",
    "read",
    "report",
    "run",
    "simulate_loads",
    "sweep",
]
