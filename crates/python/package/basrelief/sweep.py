"""Sweeps: the points of a plan, run here or by a cluster."""

from __future__ import annotations

import json
import math
import warnings
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from threading import Lock
from typing import Any

from . import _basrelief, arguments
from ._basrelief import Error
from .files import FilePath
from .renamed import warn_renamed
from .result import Result, load
from .table import Table

# Tasks per thread of a worker: few enough for the scheduler, enough to balance the load.
TASKS = 8

# A plan: its file name, its text, and the memory limit.
_Made = tuple[str, str, int | None]


@dataclass(frozen=True)
class Sweep:
    """Result of a sweep."""

    folder: Path
    """Folder of the results and tables."""
    points: int
    """Number of points."""
    reused: int
    """Points with an existing result."""
    run: int
    """Points that were run."""
    resimulated: int
    """Points resimulated from the recording of another point."""
    failed: int
    """Points that failed in this call; the table has the reasons."""
    front: str
    """The Pareto front, as text."""

    @property
    def there(self) -> int:
        """Old name of `reused`."""
        warn_renamed("Sweep.there", "Sweep.reused")
        return self.reused

    @property
    def retimed(self) -> int:
        """Old name of `resimulated`."""
        warn_renamed("Sweep.retimed", "Sweep.resimulated")
        return self.resimulated

    @property
    def table(self) -> Table:
        """All points, one row each, from `sweep.jsonl`."""
        lines = (self.folder / "sweep.jsonl").read_text().splitlines()
        return Table.of_rows([json.loads(line) for line in lines])

    def result(self, point: str) -> Result:
        """Loads the result of a point by its hash."""
        return load(self.folder / "points" / point)

    def __str__(self) -> str:
        return self.front

    def _repr_mimebundle_(self, **_: Any) -> dict[str, Any]:
        """Shows the front as a chart in a notebook. Notebooks know version 5 or 6 of Vega-Lite; the chart is the same in both."""
        chart: dict[str, Any] = json.loads((self.folder / "sweep.vl.json").read_text())
        versions = {version: chart | {"$schema": f"https://vega.github.io/schema/vega-lite/v{version}.json"} for version in (5, 6)}
        charts = {f"application/vnd.vegalite.v{version}+json": of_version for version, of_version in versions.items()}
        return {**charts, "text/plain": self.front}


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
    """Runs the points of a plan that have no result in the folder `out` yet, as `basrelief sweep` does.

    `client`: a client of Dask distributed, whose workers run the points. They must see the plan, its files and `out` under the same
    paths. Each worker process reads the plan once. If a worker dies, another one runs its unfinished points.
    `threads`: parallel runs without a client [default: one per core].
    `pictures`: write images beside the reports.
    `retry_failed`: run failed points again.
    `memory_limit`: memory limit for inputs and recordings, per process [bytes; default 1 GiB].

    Ctrl-C stops between two points and keeps finished points. Raises `InputError` for an invalid plan. Warns about a figure of the last
    image in a plan with several frames.
    """
    name, folder = Path(arguments.path("plan", plan)), Path(arguments.path("out", out))
    memory_limit, threads = _limits(memory_limit, threads)
    options = (arguments.truth("retry_failed", retry_failed), arguments.truth("pictures", pictures))
    if client is not None and not callable(getattr(client, "submit", None)):
        raise arguments.wrong("client", client, "a client of Dask distributed")
    made: _Made = (str(name.absolute()), _basrelief.read_text(name), memory_limit)
    points = _basrelief.Plan(name, made[1], memory_limit)
    _warn(name, points.warnings)
    missing = points.missing(folder, retry_failed)
    if client is None:
        tally = points.execute([point for point, _ in missing], folder, threads, options)
    else:
        tally = _on_workers(client, made, missing, folder.absolute(), options)
    if left := len(points.missing(folder, False)):
        raise Error(f"{folder}: {left} points are missing; workers must share this folder and have version {_basrelief.VERSION}")
    found, run, retimed, failed = tally
    there = len(points) - len(missing) + found
    return Sweep(folder, len(points), there, run, retimed, failed, points.tables(folder))


@dataclass(frozen=True)
class Exploration(Sweep):
    """Result of an exploration. Its points are the chosen ones."""

    grid: int
    """Number of points of the plan."""
    share: float | None
    """Share of the hypervolume of the whole grid; `None` unless all points of the grid have results."""


def explore(
    plan: FilePath,
    *,
    budget: int | None = None,
    seconds: float | None = None,
    seed: int = 0,
    out: FilePath = "out",
    threads: int | None = None,
    pictures: bool = True,
    retry_failed: bool = False,
    memory_limit: int | None = None,
) -> Exploration:
    """Finds the Pareto front of a plan with few runs, as `basrelief explore` does. The plan has one input.

    `budget`: maximum number of points. Give either `budget` or `seconds`.
    `seconds`: time after which no round of points begins.
    `seed`: choose differently among points that promise the same; 0 prefers the first in the plan.
    The other options are those of `sweep`. Points with a result in the folder `out` are not run again, so an interrupted exploration
    continues where it stopped.

    Ctrl-C stops between two points and keeps finished points. Raises `InputError` for an invalid plan, and `UsageError` unless exactly
    one limit is given. Warns as `sweep` does.
    """
    name, folder = Path(arguments.path("plan", plan)), Path(arguments.path("out", out))
    memory_limit, threads = _limits(memory_limit, threads)
    options = (arguments.truth("retry_failed", retry_failed), arguments.truth("pictures", pictures))
    count = None if budget is None else arguments.whole("budget", budget)
    time = None if seconds is None else arguments.number("seconds", seconds)
    made: _Made = (str(name), _basrelief.read_text(name), memory_limit)
    counts, front, share, texts = _basrelief.explore(made, (count, time, _seed(seed)), folder, threads, options)
    _warn(name, texts)
    grid, points, reused, run, resimulated, failed = counts
    return Exploration(folder, points, reused, run, resimulated, failed, front, grid, share)


def _warn(plan: Path, texts: list[str]) -> None:
    """Warns the caller of `sweep` or `explore` about a plan."""
    for text in texts:
        warnings.warn(f"{plan}: {text}", stacklevel=3)


def _limits(memory_limit: int | None, threads: int | None) -> tuple[int | None, int | None]:
    limit = None if memory_limit is None else arguments.whole("memory_limit", memory_limit)
    return limit, None if threads is None else arguments.whole("threads", threads, least=1)


def _seed(seed: int) -> int:
    number = arguments.whole("seed", seed)
    if number >> 32:
        raise arguments.wrong("seed", seed, "a whole number of at most 32 bits")
    return number


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
    """Groups points by recording, in batches of at most `most` points; small groups share a batch."""
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
    """Runs points in a worker."""
    with _lock:
        if made not in _plans:
            # Only one plan at a time, because its scenes can be large.
            _plans.clear()
            _basrelief.work_alone()
            _plans[made] = _basrelief.Plan(*made)
        plan = _plans[made]
    return plan.execute(points, folder, 1, options)
