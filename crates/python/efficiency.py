"""Compares workers of Dask with threads of one process, and measures the cost of a task in the scheduler."""

from __future__ import annotations

import statistics
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import basrelief
from basrelief import _basrelief
from basrelief.sweep import run_points
from distributed import Client, LocalCluster
from distributed.comm.tcp import TCP

# Sixteen works without shared results, each of some tenths of a second.
WORKS = """
input = "demo:golf-ball"
objectives = ["cycles min", "quality.psnr_db max"]
[view]
size = "640x480"
[axes]
replacement.entries = [16, 32, 64, 128]
replacement.lanes = [8, 16, 32, 64]
"""
# The maximum number of points of a plan.
POINTS = """
input = "demo:golf-ball"
objectives = ["cycles min"]
[view]
size = "16x12"
[axes]
replacement.entries = { from = 1, to = 512, step = 1 }
fifo.shaded.depth = { from = 1, to = 64, step = 1 }
"""
# Tasks for points outside the plan cost only the transfer to the worker and back.
TASKS = 2000
POINTS_OF_A_TASK = (1, 4, 16, 64)


async def _counted(comm: Any, *args: Any, **more: Any) -> Any:
    sent: int = await TCP.write_uncounted(comm, *args, **more)
    TCP.sent += sent
    return sent


def count() -> None:
    """Counts the bytes that this process sends. A sent function finds the counter in its class."""
    TCP.sent, TCP.write_uncounted, TCP.write = 0, TCP.write, _counted


def sent() -> int:
    """Returns the bytes sent by this process."""
    return int(TCP.sent)


def sweep(plan: Path, client: Any, threads: int | None) -> float:
    """Returns the seconds of a plan from an empty folder to its tables."""
    with tempfile.TemporaryDirectory() as folder:
        began = time.perf_counter()
        done = basrelief.sweep(plan, client, out=folder, threads=threads, pictures=False)
        assert done.failed == 0 and done.run == done.points, done
        return time.perf_counter() - began


def efficiency(plan: Path, client: Any, rounds: int) -> None:
    """Runs the same plan on two threads and on two workers, alternately."""
    ratios = []
    for number in range(rounds):
        one, two = sweep(plan, None, 2), sweep(plan, client, None)
        ratios.append(one / two)
        print(f"round {number + 1}: 2 threads of one process {one:.2f} s, 2 workers {two:.2f} s: {one / two:.3f}")
    print(f"efficiency of 2 workers, median: {statistics.median(ratios):.3f}")


def overhead(plan: Path, client: Any, most: int) -> None:
    """Measures the transfer cost of a task with this number of points. This process is both client and scheduler."""
    made = (str(plan), plan.read_text(), None)
    points = [f"{number:064}" for number in range(most)]
    client.run(run_points, made, points, "nowhere", (False, False))
    before, began = sent() + sum(client.run(sent).values()), time.process_time()
    tasks = [client.submit(run_points, made, points, "nowhere", (False, False), pure=False) for _ in range(TASKS)]
    client.gather(tasks)
    took = (time.process_time() - began) / TASKS
    each = (sent() + sum(client.run(sent).values()) - before) / TASKS
    print(
        f"a task of {most} points: {1e3 * took:.2f} ms of processor time of client and scheduler, "
        f"{each:.0f} bytes on all connections, {each / most:.0f} for each point"
    )


def opened(plan: Path, folder: str) -> None:
    """Measures the time to open a large plan and to list its missing points."""
    began = time.perf_counter()
    points = _basrelief.Plan(plan, plan.read_text(), None)
    took = time.perf_counter() - began
    began = time.perf_counter()
    points.missing(Path(folder), False)
    print(f"a plan of {len(points)} points: opened in {took:.2f} s, looked for in {time.perf_counter() - began:.2f} s")


def main() -> None:
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    with tempfile.TemporaryDirectory() as folder:
        works, many = Path(folder, "works.toml"), Path(folder, "many.toml")
        works.write_text(WORKS)
        many.write_text(POINTS)
        opened(many, folder)
        cluster = LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None)
        with cluster, Client(cluster) as client:
            efficiency(works, client, rounds)
            count()
            client.run(count)
            for most in POINTS_OF_A_TASK:
                overhead(works, client, most)


if __name__ == "__main__":
    main()
