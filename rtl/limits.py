"""The table of values of parameters for which the twins hold, and its copy in the guide."""

from build import HERE
from twins import TWINS

GUIDE = HERE.parent / "docs" / "guide" / "rtl.md"


def table():
    """Returns a table in Markdown of the parameters for which the twins hold."""
    rows = [f"| `{unit}` | `{key}` | {values} |" for unit, twin in TWINS.items() for key, values in twin.limits()]
    return "\n".join(["| twin | parameter | values |", "|---|---|---|", *rows])


def is_documented():
    """Returns true if the guide has this table."""
    return f"\n\n{table()}\n\n" in GUIDE.read_text(encoding="utf-8")
