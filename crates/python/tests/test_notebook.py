"""Runs the notebook in docs/ and compares its output with the stored output.

With BASRELIEF_BLESS=1 in the environment, the notebook is updated with its output.
"""

from __future__ import annotations

import os
from typing import Any

import nbformat
from conftest import ROOT
from nbclient import NotebookClient

NOTEBOOK = ROOT / "docs/guide/python.ipynb"


def shown(notebook: Any) -> list[dict[str, Any]]:
    """Returns the output of the cells. For tables only the text of pandas, because its markup differs between versions."""
    outputs = [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    assert all(output.output_type in ("execute_result", "stream") for output in outputs), outputs
    return [of_pandas_as_text(output["data"]) if "data" in output else {"text": output["text"]} for output in outputs]


def of_pandas_as_text(data: dict[str, Any]) -> dict[str, Any]:
    is_pandas = 'class="dataframe"' in data.get("text/html", "")
    # A chart is JSON, and no text.
    return {kind: content.strip() if isinstance(content, str) else content for kind, content in data.items() if not (is_pandas and kind == "text/html")}


def test_notebook_shows_current_results() -> None:
    stands = nbformat.read(NOTEBOOK, as_version=4)
    made = NotebookClient(nbformat.read(NOTEBOOK, as_version=4), timeout=120, kernel_name="python3", record_timing=False).execute()
    if os.environ.get("BASRELIEF_BLESS") == "1":
        for cell in made.cells:
            cell.metadata.clear()
        made.metadata["language_info"] = {"name": "python"}
        nbformat.write(made, NOTEBOOK)
    else:
        assert shown(made) == shown(stands), f"{NOTEBOOK} is old: BASRELIEF_BLESS=1 crates/python/check writes it anew"
