"""Parameters in the form of `--set`."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from . import arguments
from ._basrelief import UsageError

Settings = list[tuple[str, str]]


def settings(given: Mapping[str, Any] | None, named: Mapping[str, Any]) -> Settings:
    """Returns keys and values in the form of `--set`."""
    return [(key, _value(key, value)) for key, value in {**arguments.parameters(given), **named}.items()]


def _value(key: str, value: Any) -> str:
    if isinstance(value, str):
        return value
    # Converts numbers and arrays of NumPy to those of Python.
    value = value.tolist() if hasattr(value, "tolist") else value
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(_element(key, element) for element in value)}]"
    return _element(key, value)


def _element(key: str, value: Any) -> str:
    """Returns a value in TOML, which writes booleans, numbers and strings as JSON does."""
    # A list may hold numbers of NumPy.
    plain = value.tolist() if hasattr(value, "tolist") else value
    if isinstance(plain, (bool, int, float, str)):
        return json.dumps(plain)
    raise UsageError(f"`{key}`: {value!r}; expected a number, a boolean, a string or a list of these")
