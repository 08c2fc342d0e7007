"""Compares files and analyses of a run with those of the program, to the byte."""

from __future__ import annotations

import _thread
import json
import threading
import time
from pathlib import Path
from typing import Any

import basrelief
import pytest
from basrelief import Machine, UsageError
from conftest import ROOT, Program, report_of

PATCH = ROOT / "tests/models/patch.gltf"
TRACE = ROOT / "traces/patch-one-level.jsonl"


def patch(size: str = "32x24") -> tuple[list[Any], basrelief.Scene]:
    """Returns the options of the program for a small scene, and the scene."""
    width, height = map(int, size.split("x"))
    return ["run", PATCH, f"--size={size}"], basrelief.scene(PATCH, size=(width, height))


@pytest.mark.parametrize(
    ("options", "given"),
    [
        ([], {}),
        (
            ["--from-cycle=500", "--to-cycle=9000", "--units=replacement,brightness", "--tokens-every=3", "--tokens-of=polygons"],
            {"from_cycle": 500, "to_cycle": 9000, "units": ["replacement", "brightness"], "tokens_every": 3, "tokens_of": "polygons"},
        ),
    ],
    ids=["whole", "part"],
)
def test_files_over_time_equal_those_of_the_program(
    program: Program, tmp_path: Path, options: list[str], given: dict[str, Any]
) -> None:
    run, scene = patch()
    names = {"timeline": "a.pftrace", "waves": "a.fst", "tokens": "a.kanata.zst", "requests": "a.csv"}
    ours, theirs = tmp_path / "ours", tmp_path / "theirs"
    ours.mkdir()
    theirs.mkdir()
    done = program(*run, "--out", tmp_path / "out", "--json", *(f"--{key}={theirs / name}" for key, name in names.items()), *options)
    files: dict[str, Any] = {key: ours / name for key, name in names.items()}
    result = Machine("bump").run(scene, **files, **given)
    assert result.report == report_of(done)
    assert sorted(path.name for path in ours.iterdir()) == sorted(names.values())
    for name in names.values():
        assert (ours / name).read_bytes() == (theirs / name).read_bytes() != b"", name


def test_requests_in_other_formats_equal_those_of_the_program(program: Program, tmp_path: Path) -> None:
    run, scene = patch()
    for kind in ("dramsim3", "ramulator", "ramulator2"):
        chosen = [f"--requests-format={kind}", "--requests-memory=graphics"]
        done = program(*run, "--out", tmp_path / "out", "--json", f"--requests={tmp_path / 'theirs'}", *chosen)
        assert done.returncode == 0, done.stderr
        Machine("bump").run(scene, requests=tmp_path / "ours", requests_format=kind, requests_memory="graphics")
        assert (tmp_path / "ours").read_bytes() == (tmp_path / "theirs").read_bytes() != b"", kind


def test_incomplete_run_writes_its_timeline(tmp_path: Path) -> None:
    with pytest.raises(basrelief.IncompleteError):
        Machine("bump").run(patch()[1], max_cycles=1000, timeline=tmp_path / "a.pftrace")
    assert (tmp_path / "a.pftrace").stat().st_size > 1000


def test_failed_run_leaves_no_files(tmp_path: Path) -> None:
    bad = tmp_path / "bad.jsonl"
    bad.write_text('{"begin":{"format":"basrelief-display-list","version":1,"width":0}}\n')
    with pytest.raises(basrelief.InputError):
        Machine("bump").run(basrelief.display_list(bad), timeline=tmp_path / "a.pftrace", requests=tmp_path / "a.csv")
    assert [path.name for path in tmp_path.iterdir()] == ["bad.jsonl"]


@pytest.mark.parametrize("expect", [False, True])
def test_recorded_trace_equals_that_of_the_program(program: Program, tmp_path: Path, expect: bool) -> None:
    _, scene = patch()
    machine = Machine("bump", **{"replacement.entries": 64})
    for name in ("a.jsonl", "a.bdl.zst"):
        theirs = tmp_path / f"their-{name}"
        options = ["--size=32x24", "--set=replacement.entries=64", *(["--expect"] if expect else [])]
        done = program("record", PATCH, "--out", theirs, *options)
        assert done.returncode == 0, done.stderr
        commands = machine.record(scene, tmp_path / name, expect=expect)
        assert (tmp_path / name).read_bytes() == theirs.read_bytes()
        assert f"{commands:,} commands" in done.stdout
    assert program("verify", tmp_path / "a.jsonl").returncode == (0 if expect else 1)


def test_ablation_and_methods_equal_those_of_the_program(program: Program, tmp_path: Path) -> None:
    shade = Machine("shade", **{"shade.mode": "normal"})
    done = program("demo", "goblet@1", "--size=32x24", "--set=shade.mode=normal", "--ablate", "--json", "--out", tmp_path)
    ablated = shade.ablate(basrelief.demo("goblet@1", size=(32, 24)))
    assert ablated.rows() == json.loads(done.stdout)["variants"] != []
    done = program("demo", "corridor", "--size=32x24", "--compare-methods", "--json", "--out", tmp_path)
    compared = Machine("texel").compare_methods(basrelief.demo("corridor", size=(32, 24)))
    assert compared.rows() == json.loads(done.stdout)["methods"] != []
    with pytest.raises(UsageError, match="machine `shade`"):
        shade.compare_methods(basrelief.demo("goblet@1", size=(32, 24)))


@pytest.mark.parametrize("trace", [False, True])
def test_sensitivity_equals_that_of_the_program(program: Program, tmp_path: Path, trace: bool) -> None:
    run, scene = (["run", TRACE], basrelief.display_list(TRACE)) if trace else patch("16x12")
    done = program(*run, "--no-exact", "--sensitivity", "--json", "--out", tmp_path)
    result = Machine("bump").run(scene, exact=False, sensitivity=True)
    assert result.report == report_of(done)
    changed = result.sensitivity
    assert changed["parameter"] == [change["parameter"] for change in result.report["sensitivity"]["changes"]] != []


def test_ctrl_c_stops_a_sensitivity_analysis() -> None:
    scene, machine = basrelief.demo("golf-ball", size=(160, 120)), Machine("bump")
    began = time.perf_counter()
    machine.run(scene, bottlenecks=False)
    run = time.perf_counter() - began
    threading.Timer(1.0, _thread.interrupt_main).start()
    began = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        machine.run(scene, sensitivity=True, bottlenecks=False)
    # The whole analysis takes some 200 runs.
    assert time.perf_counter() - began < 1 + 40 * run


def test_fifo_sizing_equals_that_of_the_program(program: Program, tmp_path: Path) -> None:
    run, scene = patch()
    machine = Machine("bump")
    first = machine.run(scene, exact=False)
    second = machine.run(basrelief.demo("golf-ball", size=(32, 24)), exact=False)
    files = []
    for name, result in (("a", first), ("b", second)):
        result.recording.save(tmp_path / name)
        files.append(tmp_path / name)
    done = program("size-fifos", *files, "--within=0,5", "--json")
    sizing = basrelief.size_fifos([first.recording, second.recording], [0, 5])
    assert sizing.report == json.loads(done.stdout)
    assert sizing.choices["within_percent"] == [None, 0.0, 5.0]
    assert sizing.choices["slots"] == sorted(sizing.choices["slots"], reverse=True)
    smallest = sizing.depths(0)
    assert sizing.depths() == smallest
    assert machine.set(smallest).run(scene, exact=False).cycles == first.cycles
    assert first.recording.resimulate(smallest).cycles == first.cycles
    with pytest.raises(UsageError, match="within: 7; expected 0.0 or 5.0"):
        sizing.depths(7)
    other = Machine("bump", **{"replacement.lanes": 4}).run(scene, exact=False).recording
    with pytest.raises(basrelief.InputError, match="recording 2: `replacement.lanes` is 4"):
        basrelief.size_fifos([first.recording, other])


def test_figures_have_the_names_of_plans(program: Program, tmp_path: Path) -> None:
    result = Machine("bump").run(basrelief.demo("golf-ball", size=(32, 24)))
    report = result.report
    assert result.figure("cycles") == result.cycles
    assert result.figure("units.replacement.busy") == report["units"]["replacement"]["busy"]
    assert result.figure("quality.psnr_db") == report["quality"]["psnr_db"]
    assert result.figure("memories.bytes") == result.figure("bytes.moved") == report["bytes"]["moved"]
    figures = {row["figure"]: row["value"] for row in result.figures.rows()}
    assert result.figure("hardware.area_ge") == figures["hardware.area_ge"] > 0
    with pytest.raises(UsageError, match="no figure `hardware.aera_ge`; did you mean `hardware.area_ge`"):
        result.figure("hardware.aera_ge")


def test_resimulation_analyses_and_records_on_demand() -> None:
    result = Machine("bump").run(patch()[1])
    again = result.recording.resimulate({"fifo.shaded.depth": 4})
    assert "bottlenecks" not in again.report and again._recording is None
    analysed = result.recording.resimulate({"fifo.shaded.depth": 4}, bottlenecks=True)
    assert analysed.report["bottlenecks"]["single"]
    assert again.recording == result.recording.resimulate({"fifo.shaded.depth": 4}, recording=True).recording
    comparison = result.compare(again)
    assert "fifo.shaded.depth" in comparison.explanation
    rows = str(comparison).splitlines()[2:4]
    assert [row.split()[0] for row in rows] == ["A", "B"], "the names of the explanation"
