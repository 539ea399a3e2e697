"""Gymnasium environments that run an experiment in episodes, single or as a native vector environment on threads.

After ``import feeler``, create them with ``gymnasium.make("feeler/CapClosing-v0")`` or
``gymnasium.make_vec("feeler/CapClosing-v0", num_envs=256)``.
"""

from __future__ import annotations

from feeler.gym.spaces import EXPERIMENTS
from feeler.gym.tactile_env import TactileEnv
from feeler.gym.tactile_vector_env import TactileVectorEnv

__all__ = ["EXPERIMENTS", "TactileEnv", "TactileVectorEnv"]
