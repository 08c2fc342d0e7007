"""FIFO sizing."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from . import _basrelief, arguments
from .result import Recording
from .table import Table


class FifoSizing:
    """Smallest FIFO depths that keep the cycles of recordings."""

    def __init__(self, text: str) -> None:
        self.report: dict[str, Any] = json.loads(text)
        """The result as `basrelief size-fifos --json` prints it."""

    @property
    def choices(self) -> Table:
        """The recorded depths, then one row for each tolerance: tolerance [%], render cycles of each recording, slots, bits and area."""
        columns = ["within_percent", "cycles", "slots", "bits", "area_ge"]
        return Table.of_rows(self.report["choices"], columns)

    def depths(self, within: float | None = None) -> dict[str, int]:
        """Returns the depths for a tolerance [%; default: the first] as parameters, for `Machine.set` or `Recording.resimulate`."""
        found = self.report["choices"][1:]
        chosen = found[:1] if within is None else [choice for choice in found if choice["within_percent"] == within]
        if not chosen:
            raise arguments.wrong("within", within, " or ".join(str(choice["within_percent"]) for choice in found))
        return {f"fifo.{name}.depth": depth for name, depth in chosen[0]["depths"]}

    def __repr__(self) -> str:
        before, *found = (choice["slots"] for choice in self.report["choices"])
        return f"FifoSizing({self.report['machine']}, {before:,} to {' or '.join(f'{slots:,}' for slots in found)} slots)"

    def _repr_html_(self) -> str:
        return self.choices._repr_html_()


def size_fifos(
    recordings: Recording | Sequence[Recording], within: float | Sequence[float] = 0.1, *, memory_limit: int | None = None
) -> FifoSizing:
    """Finds the smallest FIFO depths that keep the render cycles of all recordings, as `basrelief size-fifos` does.

    `recordings`: recordings of the same machine with the same parameters.
    `within`: allowed increase of the render cycles [%]; a list gives one result per value.
    """
    given = [recordings] if isinstance(recordings, Recording) else recordings
    if not isinstance(given, Sequence) or not given or not all(isinstance(recording, Recording) for recording in given):
        raise arguments.wrong("recordings", recordings, "a recording, or a list of them")
    tolerances = within if isinstance(within, Sequence) and not isinstance(within, str) else [within]
    percents = [arguments.number("within", percent) for percent in tolerances]
    if not percents:
        raise arguments.wrong("within", within, "a number, or a list of numbers")
    limit = None if memory_limit is None else arguments.whole("memory_limit", memory_limit)
    return FifoSizing(_basrelief.size_fifos([recording._bytes for recording in given], percents, limit))
