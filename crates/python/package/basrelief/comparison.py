"""Comparison of two runs."""

from __future__ import annotations

import json
from functools import cached_property
from html import escape
from typing import Any

from . import _basrelief
from .files import FilePath, write
from .table import Table


class Comparison:
    """Changes from run A to run B, largest first, and their causes, as `basrelief compare` prints them."""

    def __init__(self, a: _basrelief._Side, b: _basrelief._Side) -> None:
        self._sides = (a, b)
        self._json, self._text = _basrelief.compare(a, b)

    @cached_property
    def report(self) -> dict[str, Any]:
        """The comparison as `basrelief compare --json` prints it."""
        report: dict[str, Any] = json.loads(self._json)
        return report

    @property
    def equal(self) -> bool:
        """True if the reports are equal."""
        return bool(self.report["equal"])

    @property
    def explanation(self) -> str:
        """The change of the cycles and its causes in a few sentences. If the clocks differ, the change of time comes first."""
        return str(self.report["explanation"])

    @property
    def changes(self) -> Table:
        """All figures that differ: part of the report, name, field, key, value in A, value in B, change, and change in percent of A."""
        columns = ["table", "name", "field", "key", "a", "b", "delta", "percent"]
        parts = self.report["sections"]
        return Table.of_rows([{"table": part["table"], **change} for part in parts for change in part["changes"]], columns)

    def html(self) -> str:
        """Returns the comparison as an HTML page."""
        return _basrelief.compared(*self._sides)

    def save_html(self, path: FilePath) -> None:
        """Writes the comparison as an HTML page."""
        write(path, self.html().encode())

    def __str__(self) -> str:
        return self._text

    def __repr__(self) -> str:
        return f"Comparison({self.explanation!r})"

    def _repr_html_(self) -> str:
        return f"<pre>{escape(self._text)}</pre>"
