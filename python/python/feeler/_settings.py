"""Values of an experiment as the program's ``--set`` takes them."""

from __future__ import annotations

import json
from collections.abc import Mapping

Value = bool | int | float | str | list["Value"]


def as_settings(settings: Mapping[str, Value] | None) -> list[str]:
    """``{"control.slip_threshold": 2.5}`` as ``["control.slip_threshold=2.5"]``."""
    return [f"{key}={_as_toml(value)}" for key, value in (settings or {}).items()]


def _as_toml(value: Value) -> str:
    match value:
        case bool():
            return "true" if value else "false"
        case int() | float():
            return repr(float(value)) if isinstance(value, float) else str(int(value))
        case str():
            # A string of JSON is one of TOML.
            return json.dumps(value, ensure_ascii=False)
        case _:
            return "[" + ", ".join(_as_toml(part) for part in value) + "]"
