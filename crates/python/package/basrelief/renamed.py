"""Names before version 0.2, which still work with a `DeprecationWarning`."""

from __future__ import annotations

import warnings


def warn_renamed(old: str, new: str, depth: int = 3) -> None:
    """Warns the caller of an old name."""
    warnings.warn(f"{old} is now {new}; the old name will be removed", DeprecationWarning, stacklevel=depth)


def renamed(old: str, before: bool | None, new: str, now: bool | None) -> bool | None:
    """Returns the value of an argument that was given under its new or its old name."""
    if before is None:
        return now
    warn_renamed(f"the argument {old}", new, 4)
    return before
