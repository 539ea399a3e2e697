"""A hand with touch as a robot of LeRobot.

LeRobot finds this package by its name and creates the robot from its type, ``feeler``::

    lerobot-teleoperate --robot.type=feeler --robot.experiment=grip --robot.simulated=true --teleop.type=...
"""

from lerobot_robot_feeler.config_feeler_hand import FeelerHandConfig
from lerobot_robot_feeler.feeler_hand import FeelerHand, HandStoppedError, StaleObservationError
from lerobot_robot_feeler.program import ProgramError

__all__ = ["FeelerHand", "FeelerHandConfig", "HandStoppedError", "ProgramError", "StaleObservationError"]
