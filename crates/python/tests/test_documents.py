"""Runs the examples in documents and checks their output."""

from __future__ import annotations

import ast
import re
from pathlib import Path
from typing import Any

import pytest
from conftest import ROOT, Program
from pandas.api.types import is_numeric_dtype


def blocks(text: str) -> list[str]:
    """Returns the examples in Python."""
    return re.findall(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def check(code: str, place: str, names: dict[str, Any]) -> int:
    """Runs an example. A value in a comment behind an expression must equal the expression. Returns the number of such values."""
    checked = 0
    lines = code.splitlines()
    for statement in ast.parse(code).body:
        if not isinstance(statement, ast.Expr):
            exec(compile(ast.Module([statement], []), place, "exec"), names)
            continue
        value = eval(compile(ast.Expression(statement.value), place, "eval"), names)
        _, _, comment = lines[(statement.end_lineno or 1) - 1].partition("# ")
        try:
            said = ast.literal_eval(comment)
        except (SyntaxError, ValueError):
            continue  # The comment is prose.
        assert value == said, f"{place}: {ast.unparse(statement)}"
        checked += 1
    return checked


@pytest.mark.parametrize(("document", "values"), [("docs/guide/python.md", 8), ("README.md", 1)])
def test_examples_give_what_they_say(document: str, values: int, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    examples = blocks((ROOT / document).read_text())
    assert sum(check(example, document, names) for example in examples) == values


def test_pandas_recipe_gives_numbers(program: Program, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    guide = (ROOT / "docs/guide/read-a-report.md").read_text()
    recipe = re.search(r"^python3 -c '\n(import pandas.*?)'$", guide, re.MULTILINE | re.DOTALL)
    assert recipe
    assert program("demo", "golf-ball", "--size", "32x24", "--csv").returncode == 0
    names: dict[str, Any] = {}
    exec(compile(recipe[1], "read-a-report.md", "exec"), names)
    assert all(is_numeric_dtype(kind) for kind in names["units"].dtypes)
    assert "done" in names["units"].columns
