"""Tables: named columns of equal length."""

from __future__ import annotations

import json
from html import escape
from importlib import import_module
from typing import Any

from ._basrelief import UsageError

_LIBRARIES = ("pandas", "polars")


class Table(dict[str, list[Any]]):
    """A dictionary of columns of equal length, which `pandas.DataFrame` accepts. `polars.DataFrame` accepts it if each column has one
    type; `frame` converts the others."""

    @classmethod
    def of_rows(cls, rows: list[dict[str, Any]], columns: list[str] | None = None) -> Table:
        """Makes a table of these rows. A missing value is `None`."""
        names = columns or list(dict.fromkeys(name for row in rows for name in row))
        return cls({name: [row.get(name) for row in rows] for name in names})

    def rows(self) -> list[dict[str, Any]]:
        """Returns the rows as dictionaries."""
        return [dict(zip(self, values, strict=True)) for values in zip(*self.values(), strict=True)]

    def frame(self, library: str = "pandas") -> Any:
        """Returns a data frame of pandas or polars, which must be installed. For polars, a column of several types is text."""
        if library not in _LIBRARIES:
            raise UsageError(f"frame: `{library}`; expected {' or '.join(_LIBRARIES)}")
        try:
            module = import_module(library)
        except ModuleNotFoundError as error:
            cure = f"install {library}, for example with `pip install {library}`"
            raise ModuleNotFoundError(f"frame: {error}; {cure}", name=error.name) from error
        columns = self if library == "pandas" else {name: _of_one_type(column) for name, column in self.items()}
        return module.DataFrame(dict(columns))

    def _repr_html_(self) -> str:
        def line(kind: str, cells: list[Any]) -> str:
            return "<tr>" + "".join(f"<{kind}>{escape(_shown(cell))}</{kind}>" for cell in cells) + "</tr>"

        body = "".join(line("td", list(row.values())) for row in self.rows())
        return f"<table><thead>{line('th', list(self))}</thead><tbody>{body}</tbody></table>"


def _of_one_type(column: list[Any]) -> list[Any]:
    """Returns a column with one type besides `None`: as it is, as numbers, or as text."""
    kinds = _types(column)
    if kinds <= {int, float}:
        return [None if cell is None else float(cell) for cell in column] if float in kinds else column
    lists = [cell for cell in column if cell is not None]
    parts = {kind for cell in lists for kind in _types(cell)} if kinds == {list} else set()
    if len(kinds) <= 1 and len(parts) <= 1:
        return column
    return [cell if cell is None or isinstance(cell, str) else json.dumps(cell) for cell in column]


def _types(cells: list[Any]) -> set[type]:
    return {type(cell) for cell in cells if cell is not None}


def _shown(cell: Any) -> str:
    if cell is None:
        return ""
    return f"{cell:,}" if isinstance(cell, int) and not isinstance(cell, bool) else str(cell)
