"""Registers the environments with Gymnasium without importing it unless it is used."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from importlib.util import find_spec
from types import ModuleType

EXPERIMENTS = {
    "CapClosing": "cap-closing",
    "CapUntilClosed": "cap-until-closed",
    "Lift": "lift",
    "Grip": "grip",
    "SlideBox": "slide-box-two",
    "Contour": "contour",
}
"""Experiment of each environment."""


def register() -> None:
    """Registers ``feeler/NAME-v0`` with Gymnasium."""
    from gymnasium.envs.registration import register as register_environment

    for name, experiment in EXPERIMENTS.items():
        register_environment(
            id=f"feeler/{name}-v0",
            entry_point="feeler.gym:TactileEnv",
            vector_entry_point="feeler.gym:TactileVectorEnv",
            kwargs={"experiment": experiment},
        )


def register_once_imported() -> None:
    """Registers now if Gymnasium has been imported, otherwise once it is imported."""
    if "gymnasium" in sys.modules:
        register()
    else:
        sys.meta_path.insert(0, _GymnasiumFinder())


class _GymnasiumFinder(MetaPathFinder):
    """Delegates the import of Gymnasium to the other finders, and wraps its loader to register the environments afterwards."""

    def find_spec(self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None) -> ModuleSpec | None:
        if fullname != "gymnasium":
            return None
        sys.meta_path.remove(self)
        spec = find_spec(fullname)
        if spec is not None and spec.loader is not None:
            spec.loader = _RegisteringLoader(spec.loader)
        return spec


class _RegisteringLoader(Loader):
    def __init__(self, loader: Loader) -> None:
        self._loader = loader

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        return self._loader.create_module(spec)

    def exec_module(self, module: ModuleType) -> None:
        self._loader.exec_module(module)
        register()
