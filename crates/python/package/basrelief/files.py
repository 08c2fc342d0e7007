"""Paths of files, and atomic writing."""

from __future__ import annotations

from os import PathLike

from . import _basrelief, arguments

FilePath = str | PathLike[str]


def optional_path(name: str, value: FilePath | None) -> str | None:
    """Returns the path of a file, if there is one."""
    return None if value is None else arguments.path(name, value)


def write(path: FilePath, content: bytes) -> None:
    """Writes a temporary file and renames it to its path."""
    _basrelief.write(arguments.path("path", path), content)
