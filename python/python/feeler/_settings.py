"""Conversion of settings into arguments of the program's ``--set`` option."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping

Value = bool | int | float | str | list["Value"] | Mapping[str, "Value"]


def as_settings(settings: Mapping[str, Value] | None) -> list[str]:
    """Converts ``{"control": {"slip_threshold": 2.5}}`` into ``["control.slip_threshold=2.5"]``; dotted keys are accepted."""
    return [f"{key}={_as_toml(value)}" for key, value in _flat(settings or {})]


def _flat(settings: Mapping[str, Value]) -> Iterator[tuple[str, Value]]:
    for key, value in settings.items():
        if isinstance(value, Mapping) and value:
            yield from ((f"{key}.{below}", single) for below, single in _flat(value))
        else:
            yield str(key), value


def _as_toml(value: Value) -> str:
    match value:
        case bool():
            return "true" if value else "false"
        case int() | float():
            return repr(float(value)) if isinstance(value, float) else str(int(value))
        case str():
            # A JSON string is a valid TOML string.
            return json.dumps(value, ensure_ascii=False)
        case Mapping():
            return "{" + ", ".join(f"{json.dumps(key)} = {_as_toml(part)}" for key, part in value.items()) + "}"
        case _:
            return "[" + ", ".join(_as_toml(part) for part in value) + "]"
