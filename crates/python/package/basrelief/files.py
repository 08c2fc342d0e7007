"""Atomic writing of files."""

from __future__ import annotations

import os
import tempfile
from os import PathLike
from pathlib import Path

from . import arguments

FilePath = str | PathLike[str]


def optional_path(name: str, value: FilePath | None) -> str | None:
    """Returns the path of a file, if there is one."""
    return None if value is None else arguments.path(name, value)


def write(path: FilePath, content: bytes) -> None:
    """Writes a temporary file and renames it to its path."""
    place = Path(path)
    handle, name = tempfile.mkstemp(dir=place.parent, prefix=f".{place.name}.")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        # The usual permissions; `mkstemp` gives access to the owner only.
        os.chmod(name, 0o666 & ~_umask())
        os.replace(name, place)
    except BaseException:
        os.unlink(name)
        raise


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
