"""Compares sweeps, local and on workers, with those of the program, to the byte."""

from __future__ import annotations

import os
import re
import signal
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import basrelief
import pytest
from basrelief.sweep import _batches  # type: ignore[import-not-found,unused-ignore]
from conftest import ROOT, Program
from distributed import Client, LocalCluster

# Six works, each with four timings. The FIFO that is too shallow for its users' tokens is not one of them.
PLAN = """
title = "Modes and depths"
input = ["demo:ellipsoid@2", "patch.obj"]
machine = "shade"
objectives = ["cycles min", "quality.psnr_db max"]

[view]
size = "96x72"
turn = [10, -20]

[axes]
shade.mode = ["normal", "brightness", "polyhedron"]
fifo.interpolated.depth = { from = 1, to = 8, factor = 2 }
"""
POINTS = 24


@pytest.fixture
def plan(tmp_path: Path) -> Path:
    for name in ("patch.obj", "patch.mtl", "bumps.png", "checks.png"):
        (tmp_path / name).write_bytes((ROOT / "tests/models" / name).read_bytes())
    plan = tmp_path / "plan.toml"
    plan.write_text(PLAN)
    return plan


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    cluster = LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None)
    with cluster, Client(cluster) as client:
        yield client


def test_file_in_the_place_of_the_folder_is_named(plan: Path, tmp_path: Path) -> None:
    taken = tmp_path / "taken"
    taken.write_text("mine")
    for out in (taken, taken / "deeper"):
        expected = f"{out}: cannot be written: {taken} is a file, expected a folder; choose another folder"
        with pytest.raises(basrelief.InputError) as swept:
            basrelief.sweep(plan, out=out)
        with pytest.raises(basrelief.InputError) as explored:
            basrelief.explore(plan, budget=4, out=out)
        assert [str(error.value) for error in (swept, explored)] == [expected, expected]
    assert taken.read_text() == "mine"


def files(folder: Path) -> dict[str, bytes]:
    """Returns all files of a folder except unfinished ones, with names that begin with a point."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and not path.name.startswith(".")
    }


@pytest.fixture
def expected(program: Program, plan: Path) -> dict[str, bytes]:
    """Returns the files that the program writes."""
    done = program("sweep", plan, "--out", plan.parent / "program")
    assert done.returncode == 0, done.stderr
    return files(plan.parent / "program")


def test_a_sweep_is_that_of_the_program_and_resumes(plan: Path, expected: dict[str, bytes], tmp_path: Path) -> None:
    out = tmp_path / "here"
    done = basrelief.sweep(plan, out=out)
    assert (done.points, done.reused, done.run, done.resimulated, done.failed) == (POINTS, 0, 6, 18, 0)
    assert files(out) == expected
    again = basrelief.sweep(plan, out=out)
    assert (again.reused, again.run, again.resimulated, str(again)) == (POINTS, 0, 0, str(done))
    table = done.table
    assert len(table.rows()) == POINTS
    hashes = sorted(path.name for path in (out / "points").iterdir())
    assert done.result(hashes[0]).cycles > 0


def test_an_exploration_is_that_of_the_program_and_resumes(plan: Path, program: Program, tmp_path: Path) -> None:
    plan.write_text(PLAN.replace('["demo:ellipsoid@2", "patch.obj"]', '"demo:ellipsoid@2"'))
    expected, out = tmp_path / "program", tmp_path / "here"
    said = program("explore", str(plan), "--budget", "5", "--out", str(expected)).stdout
    found = basrelief.explore(plan, budget=5, out=out)
    assert (found.grid, found.failed) == (POINTS // 2, 0)
    assert files(out) == files(expected) and str(found).splitlines()[-1] in said
    again = basrelief.explore(plan, budget=5, out=out)
    assert (again.reused, again.run, again.resimulated, str(again)) == (again.points, 0, 0, str(found))
    for limit in ({}, {"budget": 5, "seconds": 1.0}, {"budget": 0}, {"seconds": 0.0}, {"seconds": -1.0}):
        with pytest.raises(basrelief.UsageError, match="`budget`.*`seconds`"):
            basrelief.explore(plan, out=out, **limit)


def test_an_exploration_takes_a_seed_and_a_time(plan: Path, program: Program, tmp_path: Path) -> None:
    # Depths without effect, so that points tie.
    depths = "fifo.interpolated.depth = [8, 9, 10, 11, 12]\nfifo.draws.depth = [16, 17, 18, 19, 20]\n"
    text = PLAN.replace('["demo:ellipsoid@2", "patch.obj"]', '"demo:ellipsoid@2"')
    plan.write_text(text.replace(text[text.index("fifo.") :], depths))
    chosen = []
    for seed in (0, 1):
        expected, out = tmp_path / f"program-{seed}", tmp_path / f"here-{seed}"
        program("explore", plan, "--budget", 6, "--seed", seed, "--out", expected)
        assert basrelief.explore(plan, budget=6, seed=seed, out=out).points == 6
        assert files(out) == files(expected)
        chosen.append({path.name for path in (out / "points").iterdir()})
    assert chosen[0] != chosen[1], "another seed chooses other points"
    timed = basrelief.explore(plan, seconds=600.0, out=tmp_path / "timed")
    assert (timed.points, timed.share) == (timed.grid, 1.0)


def test_workers_leave_the_same_bytes(client: Any, plan: Path, expected: dict[str, bytes], tmp_path: Path) -> None:
    out = tmp_path / "workers"
    done = basrelief.sweep(plan, client, out=out)
    assert (done.points, done.reused, done.run + done.resimulated, done.failed) == (POINTS, 0, POINTS, 0)
    assert files(out) == expected
    again = basrelief.sweep(plan, client, out=out)
    assert (again.reused, again.run, again.resimulated) == (POINTS, 0, 0)


def test_a_killed_worker_costs_nothing_but_time(
    client: Any, plan: Path, expected: dict[str, bytes], tmp_path: Path
) -> None:
    out = tmp_path / "killed"
    killed: list[int] = []
    # Requested before the sweep, because a busy worker takes as long to answer as for many points.
    victim = next(iter(client.run(os.getpid).values()))

    def kill() -> None:
        while (finished := len(list(out.glob("points/*/report.json")))) < 3:
            time.sleep(0.001)
        os.kill(victim, signal.SIGKILL)
        killed.append(finished)

    thread = threading.Thread(target=kill, daemon=True)
    thread.start()
    done = basrelief.sweep(plan, client, out=out)
    thread.join(timeout=10)
    assert killed and killed[0] < POINTS, "in the middle"
    assert victim not in client.run(os.getpid).values()
    assert (done.points, done.failed) == (POINTS, 0)
    assert files(out) == expected


def test_invalid_plan_has_the_error_of_the_program(
    client: Any, program: Program, plan: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(plan.parent)
    good = plan.read_text()
    for old, new in [
        ("shade.mode", "shade.mood"),
        ("cycles min", "cycels min"),
        ('"96x72"', '"96"'),
        ("turn", "turned"),
        ("[view]", "[[view]]"),
        ("cycles min", "cycles least"),
        ("patch.obj", "none.obj"),
        ("demo:ellipsoid@2", "demo:teapot"),
        ("[axes]", "[axes"),
    ]:
        plan.write_text(good.replace(old, new))
        said = program("sweep", "plan.toml").stderr
        with pytest.raises(basrelief.InputError) as raised:
            basrelief.sweep("plan.toml", client)
        # Package and program describe the options and the form of a view in different words.
        words = str(raised.value).partition(" (basrelief.scene")[0].rpartition("view.size: ")[2]
        assert words in said, f"{raised.value}\n{said}"
        assert not (plan.parent / "out").exists()


def test_a_point_that_fails_is_a_row(client: Any, tmp_path: Path) -> None:
    scene, machine = basrelief.demo("golf-ball", size=(48, 36)), basrelief.Machine("bump")
    totals = [machine.set({"replacement.entries": n}).run(scene).report["cycles"]["total"] for n in (16, 1024)]
    plan = tmp_path / "plan.toml"
    plan.write_text(
        f'input = "demo:golf-ball"\nobjectives = ["cycles min"]\nmax_cycles = {sum(totals) // 2}\n[view]\nsize = "48x36"\n'
        "[axes]\nreplacement.entries = [16, 1024]\n"
    )
    here, there = basrelief.sweep(plan, out=tmp_path / "here"), basrelief.sweep(plan, client, out=tmp_path / "there")
    assert here.failed == there.failed == 1
    assert files(tmp_path / "here") == files(tmp_path / "there")
    assert "failed" in str(here.table)
    assert basrelief.sweep(plan, client, out=tmp_path / "there").run == 0
    assert basrelief.sweep(plan, client, out=tmp_path / "there", retry_failed=True).run == 1


def test_sweep_shows_its_front_in_a_notebook(plan: Path, tmp_path: Path) -> None:
    plan.write_text(PLAN.replace('"demo:ellipsoid@2", "patch.obj"', '"demo:ellipsoid@2"').replace("to = 8", "to = 2"))
    done = basrelief.sweep(plan, out=tmp_path / "points")
    bundle = done._repr_mimebundle_()
    assert bundle["text/plain"] == done.front
    for version in (5, 6):
        chart = bundle[f"application/vnd.vegalite.v{version}+json"]
        assert chart["$schema"].endswith(f"/v{version}.json")
        assert len(chart["data"]["values"]) == done.points == 6
        assert any(point["front"] for point in chart["data"]["values"])


def test_figure_of_the_last_image_is_a_warning(tmp_path: Path) -> None:
    plan = tmp_path / "plan.toml"
    plan.write_text(
        'input = "demo:ellipsoid@2"\nmachine = "shade"\nobjectives = ["cycles min", "quality.psnr_db max"]\n'
        '[view]\nsize = "16x12"\nframes = 2\n[axes]\nfifo.interpolated.depth = [8]\n'
    )
    text = "objectives: `quality.psnr_db` is that of the last image; `quality.min.psnr_db` is that of the worst image"
    with pytest.warns(UserWarning, match=re.escape(f"{plan}: {text}")) as swept:
        basrelief.sweep(plan, out=tmp_path / "swept")
    with pytest.warns(UserWarning, match=re.escape(text)) as explored:
        basrelief.explore(plan, budget=1, out=tmp_path / "explored")
    # The warning names the line of the caller.
    assert {warning.filename for warning in [*swept, *explored]} == {__file__}


def test_batches_group_points_by_recording() -> None:
    points = [(f"{work}{n}", work) for work, count in (("a", 5), ("b", 1), ("c", 1), ("d", 2)) for n in range(count)]
    assert _batches(points, 3) == [["a0", "a1", "a2"], ["a3", "a4", "b0"], ["c0", "d0", "d1"]]
    assert _batches([], 0) == []
