"""What Gymnasium calls when it is imported: light, as everybody who has both packages pays for it."""

from __future__ import annotations

EXPERIMENTS = {
    "CapClosing": "cap-closing",
    "CapUntilClosed": "cap-until-closed",
    "Lift": "lift",
    "SlideBox": "slide-box-two",
    "Contour": "contour",
}
"""The experiment behind each environment."""


def register() -> None:
    """Registers ``feeler/NAME-v0``; Gymnasium puts the namespace before."""
    from gymnasium.envs.registration import register as register_environment

    for name, experiment in EXPERIMENTS.items():
        register_environment(
            id=f"{name}-v0",
            entry_point="feeler.gym:TactileEnv",
            vector_entry_point="feeler.gym:TactileVectorEnv",
            kwargs={"experiment": experiment},
        )
