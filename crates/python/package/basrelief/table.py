"""Tables: named columns of equal length."""

from __future__ import annotations

from html import escape
from importlib import import_module
from typing import Any

from ._basrelief import UsageError

_LIBRARIES = ("pandas", "polars")


class Table(dict[str, list[Any]]):
    """A dictionary of columns of equal length, which `pandas.DataFrame` and `polars.DataFrame` accept."""

    @classmethod
    def of_rows(cls, rows: list[dict[str, Any]], columns: list[str] | None = None) -> Table:
        """Makes a table of these rows. A missing value is `None`."""
        names = columns or list(dict.fromkeys(name for row in rows for name in row))
        return cls({name: [row.get(name) for row in rows] for name in names})

    def rows(self) -> list[dict[str, Any]]:
        """Returns the rows as dictionaries."""
        return [dict(zip(self, values, strict=True)) for values in zip(*self.values(), strict=True)]

    def frame(self, library: str = "pandas") -> Any:
        """Returns a data frame of pandas or polars, which must be installed."""
        if library not in _LIBRARIES:
            raise UsageError(f"frame: `{library}`; expected {' or '.join(_LIBRARIES)}")
        try:
            module = import_module(library)
        except ModuleNotFoundError as error:
            cure = f"install {library}, for example with `pip install {library}`"
            raise ModuleNotFoundError(f"frame: {error}; {cure}", name=error.name) from error
        return module.DataFrame(dict(self))

    def _repr_html_(self) -> str:
        def line(kind: str, cells: list[Any]) -> str:
            return "<tr>" + "".join(f"<{kind}>{escape(_shown(cell))}</{kind}>" for cell in cells) + "</tr>"

        body = "".join(line("td", list(row.values())) for row in self.rows())
        return f"<table><thead>{line('th', list(self))}</thead><tbody>{body}</tbody></table>"


def _shown(cell: Any) -> str:
    if cell is None:
        return ""
    return f"{cell:,}" if isinstance(cell, int) and not isinstance(cell, bool) else str(cell)
