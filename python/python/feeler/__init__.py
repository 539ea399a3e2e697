"""Tri-axial tactile sensing and control: camera picture to forces to finger velocities, and a simulated rig.

SI units everywhere, angles in radians; frames and signs as in the documentation of each array.
"""

from __future__ import annotations

from feeler._core import __version__
from feeler.sensing import Calibration, Felt, Fingertip, Layout, Thresholds, calibrate, locate

__all__ = [
    "Calibration",
    "Felt",
    "Fingertip",
    "Layout",
    "Thresholds",
    "__version__",
    "calibrate",
    "locate",
]
