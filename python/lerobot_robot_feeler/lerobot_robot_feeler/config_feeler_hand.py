"""Configuration of the hand."""

from __future__ import annotations

from dataclasses import dataclass, field

from lerobot.robots.config import RobotConfig


@RobotConfig.register_subclass("feeler")
@dataclass(kw_only=True)
class FeelerHandConfig(RobotConfig):
    """A hand that ``feeler follow`` controls."""

    experiment: str = "cap-closing"
    """Experiment file, or name of a built-in experiment, that describes hand, fingertips and limits."""
    simulated: bool = False
    """Simulates the rig. Otherwise ``feeler sense --publish`` of each finger and ``feeler rig`` (or ``feeler world``)
    must run with the same experiment."""
    program: str = "feeler"
    """The program ``feeler``."""
    arguments: list[str] = field(default_factory=list)
    """Further arguments of ``feeler follow``, such as ``["--sensing", "direct", "--out", "runs/first"]``."""
    lifetime: float = 0.2
    """Time after which the fingers stand still without a new action, s."""
    max_age: float = 0.1
    """Maximum age of the joint angles and forces of an observation, s."""
    connect_timeout: float = 30.0
    """Time to wait for the programs of the rig, s."""
