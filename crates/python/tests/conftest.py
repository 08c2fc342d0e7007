"""Fixtures of the tests."""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[3]
Program = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture(scope="session")
def program() -> Program:
    """Runs the command line with options."""

    def run(*options: object) -> subprocess.CompletedProcess[str]:
        command = [os.environ["BASRELIEF_PROGRAM"], *map(str, options)]
        # As wide as the text of the package.
        return subprocess.run(command, capture_output=True, text=True, check=False, env={**os.environ, "COLUMNS": "120"})

    return run


def report_of(done: subprocess.CompletedProcess[str]) -> dict[str, Any]:
    """Returns the report printed by the program, without the figures of the host."""
    assert done.returncode == 0, done.stderr
    report: dict[str, Any] = json.loads(done.stdout)
    del report["host"]
    return report
