"""What changed from one run to another."""

from __future__ import annotations

import json
from functools import cached_property
from html import escape
from typing import Any

from . import _basrelief
from .files import FilePath, write
from .table import Table


class Comparison:
    """What changed from run A to run B, the largest change first, and what explains it: what `basrelief compare` says."""

    def __init__(self, a: _basrelief._Side, b: _basrelief._Side) -> None:
        self._sides = (a, b)
        self._json, self._text = _basrelief.compare(a, b)

    @cached_property
    def report(self) -> dict[str, Any]:
        """All of it, as `basrelief compare --json` prints it."""
        report: dict[str, Any] = json.loads(self._json)
        return report

    @property
    def equal(self) -> bool:
        """Nothing differs."""
        return bool(self.report["equal"])

    @property
    def explanation(self) -> str:
        """What the cycles have changed by, and through what, in one or two sentences."""
        return str(self.report["explanation"])

    @property
    def changes(self) -> Table:
        """Every figure that differs: the part of the report that it is of, its name, field and key, in A, in B, the change, and that
        in percent of A."""
        columns = ["table", "name", "field", "key", "a", "b", "delta", "percent"]
        parts = self.report["sections"]
        return Table.of_rows([{"table": part["table"], **change} for part in parts for change in part["changes"]], columns)

    def html(self) -> str:
        """The comparison as one page."""
        return _basrelief.compared(*self._sides)

    def save_html(self, path: FilePath) -> None:
        """Writes the comparison as one page."""
        write(path, self.html().encode())

    def __str__(self) -> str:
        return self._text

    def __repr__(self) -> str:
        return f"Comparison({self.explanation!r})"

    def _repr_html_(self) -> str:
        return f"<pre>{escape(self._text)}</pre>"
