"""Checks of arguments, so that errors name the argument, its value and the expected values."""

from __future__ import annotations

import operator
import os
from collections.abc import Iterable, Mapping
from typing import Any

from ._basrelief import DisplayList, Scene, UsageError

# Bound of whole numbers: 64 bits.
_BOUND = 1 << 64


def whole(name: str, value: Any, *, least: int = 0) -> int:
    """Returns a whole number."""
    try:
        number = operator.index(value)
    except TypeError:
        number = -1
    if isinstance(value, bool) or not least <= number < _BOUND:
        raise wrong(name, value, f"a whole number from {least} on")
    return number


def number(name: str, value: Any) -> float:
    """Returns a number."""
    if not isinstance(value, (str, bytes, bool)):
        try:
            return float(value)
        except (TypeError, ValueError, OverflowError):
            pass
    raise wrong(name, value, "a number")


def numbers(name: str, value: Any, count: int) -> tuple[float, ...]:
    """Returns this count of numbers."""
    parts = _parts(value)
    if len(parts) != count:
        raise wrong(name, value, f"{count} numbers")
    return tuple(number(name, part) for part in parts)


def size(name: str, value: Any) -> tuple[int, int]:
    """Returns width and height."""
    parts = _parts(value)
    if len(parts) != 2:
        raise wrong(name, value, "width and height, for example (320, 240)")
    width, height = (whole(name, part, least=1) for part in parts)
    return width, height


def path(name: str, value: Any) -> str:
    """Returns the path of a file."""
    if isinstance(value, (str, os.PathLike)):
        return os.fsdecode(value)
    raise wrong(name, value, "a path")


def path_of_format(name: str, value: Any, ending: str) -> str:
    """Returns the path of a file in the only format that is written. The ending of another format is an error."""
    file = path(name, value)
    if os.path.splitext(file)[1].lower() not in ("", ending):
        raise wrong(name, file, f"a name that ends in {ending}, the format that is written")
    return file


def parameters(value: Any) -> Mapping[str, Any]:
    """Returns parameters by key. `None` stands for no parameters."""
    if value is None:
        return {}
    if isinstance(value, Mapping) and all(isinstance(key, str) for key in value):
        return value
    raise wrong("given", value, "a mapping from keys to values, for example {'clock.hz': 1e8}")


def word(name: str, value: Any) -> str:
    """Returns a word."""
    if isinstance(value, str):
        return value
    raise wrong(name, value, "a string")


def words(name: str, value: Any) -> list[str]:
    """Returns a list of words."""
    if isinstance(value, str) or not isinstance(value, Iterable):
        raise wrong(name, value, "a list of strings")
    return [word(name, part) for part in value]


def truth(name: str, value: Any) -> bool:
    """Returns a boolean."""
    if isinstance(value, bool) or type(value).__name__ in ("bool", "bool_"):
        return bool(value)
    raise wrong(name, value, "True or False")


def drawn(value: Any) -> Scene | DisplayList:
    """Returns a scene or a trace."""
    if isinstance(value, (Scene, DisplayList)):
        return value
    openers = "basrelief.demo, basrelief.scene or basrelief.display_list"
    raise wrong("scene", value, f"the result of {openers}")


def wrong(name: str, value: Any, expected: str) -> UsageError:
    """Returns the error of an argument."""
    return UsageError(f"{name}: {value!r}; expected {expected}")


def _parts(value: Any) -> list[Any]:
    return [] if isinstance(value, (str, bytes)) or not isinstance(value, Iterable) else list(value)
