"""Gymnasium environments: an experiment as episodes, single and as a native vector on threads.

After ``import feeler``, ``gymnasium.make("feeler/CapClosing-v0")`` and
``gymnasium.make_vec("feeler/CapClosing-v0", num_envs=256)`` make them.
"""

from __future__ import annotations

from feeler.gym.spaces import EXPERIMENTS
from feeler.gym.tactile_env import TactileEnv
from feeler.gym.tactile_vector_env import TactileVectorEnv

__all__ = ["EXPERIMENTS", "TactileEnv", "TactileVectorEnv"]
