"""Sweeps: all points of a plan, here or on many machines."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from threading import Lock
from typing import Any

from . import _basrelief
from ._basrelief import Error
from .files import FilePath
from .result import Result, load
from .table import Table

# Tasks for each thread of a worker: few enough for the scheduler, enough for all to end together.
TASKS = 8

# What a plan is made of: its file's name, its text, and the limit of memory.
_Made = tuple[str, str, int | None]


@dataclass(frozen=True)
class Sweep:
    """What a sweep has come to."""

    folder: Path
    """Where points and tables lie."""
    points: int
    """All that are there now."""
    there: int
    """Of these, those that were there before."""
    run: int
    """Those that were run."""
    retimed: int
    """Those that were timed again, from the tape of one that did the same work."""
    failed: int
    """Those run here that have failed: rows of the table, with the reason."""
    front: str
    """The points that no other beats, in words."""

    @property
    def table(self) -> Table:
        """All points, one row each: `sweep.jsonl`."""
        lines = (self.folder / "sweep.jsonl").read_text().splitlines()
        return Table.of_rows([json.loads(line) for line in lines])

    def result(self, point: str) -> Result:
        """The result of a point that has not failed, by its hash."""
        return load(self.folder / "points" / point)

    def __str__(self) -> str:
        return self.front


def sweep(
    plan: FilePath,
    client: Any = None,
    *,
    out: FilePath = "out",
    threads: int | None = None,
    pictures: bool = True,
    retry_failed: bool = False,
    memory_limit: int | None = None,
) -> Sweep:
    """All points of a plan, or what is missing of them in the folder `out`, as `basrelief sweep` has it.

    `client`: of Dask distributed; its workers run the points. They must see the plan, what it names, and `out`, under the same names.
    What a worker needs of a plan is made once in its process; what a worker that dies has not finished, another runs.
    `threads`: points under way at a time where there is no client; by itself one for each core.
    `pictures`: write a picture of each point beside its report.
    `retry_failed`: run points that failed again.
    `memory_limit`: for what inputs and tapes hold, in each process [bytes; default 1 GiB].

    Ctrl-C ends it between two points; those that are finished stay. Raises `InputError` for a plan that makes no sense.
    """
    name, folder = Path(plan), Path(out)
    made: _Made = (str(name.absolute()), _basrelief.read_text(name), memory_limit)
    points = _basrelief.Plan(name, made[1], memory_limit)
    missing = points.missing(folder, retry_failed)
    options = (retry_failed, pictures)
    if client is None:
        tally = points.execute([point for point, _ in missing], folder, threads, options)
    else:
        tally = _on_workers(client, made, missing, folder.absolute(), options)
    if left := len(points.missing(folder, False)):
        raise Error(f"{folder}: {left} points are missing: workers must share this folder, and have version {_basrelief.VERSION}")
    found, run, retimed, failed = tally
    there = len(points) - len(missing) + found
    return Sweep(folder, len(points), there, run, retimed, failed, points.tables(folder))


_Tally = tuple[int, int, int, int]


def _on_workers(
    client: Any, made: _Made, missing: list[tuple[str, str]], folder: Path, options: tuple[bool, bool]
) -> _Tally:
    threads = sum(client.nthreads().values())
    batches = _batches(missing, math.ceil(len(missing) / max(TASKS * threads, 1)))
    tasks = [client.submit(run_points, made, batch, str(folder), options, pure=False) for batch in batches]
    try:
        tallies = client.gather(tasks)
    finally:
        client.cancel(tasks)
    there, run, retimed, failed = (sum(counts) for counts in zip((0, 0, 0, 0), *tallies, strict=True))
    return there, run, retimed, failed


def _batches(missing: list[tuple[str, str]], most: int) -> list[list[str]]:
    """Points that share their work together, as far as no batch has more than `most`; small groups, several in one."""
    batches: list[list[str]] = []
    for _, group in groupby(missing, key=lambda point: point[1]):
        points = [point for point, _ in group]
        if batches and len(batches[-1]) + len(points) <= most:
            batches[-1] += points
        else:
            batches += [points[start : start + most] for start in range(0, len(points), most)]
    return batches


_plans: dict[_Made, _basrelief.Plan] = {}
_lock = Lock()


def run_points(made: _Made, points: list[str], folder: str, options: tuple[bool, bool]) -> _Tally:
    """A worker's task."""
    with _lock:
        if made not in _plans:
            # One at a time: its scenes can be large.
            _plans.clear()
            _basrelief.work_alone()
            _plans[made] = _basrelief.Plan(*made)
        plan = _plans[made]
    return plan.execute(points, folder, 1, options)
