"""Compares the package with the program."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import basrelief
import pytest
from conftest import ROOT, Program, report_of

PATCH = ROOT / "tests/models/patch.gltf"
TRACE = ROOT / "traces/patch-per-polygon.jsonl"

# A demo for each machine, with parameters and a view.
RUNS: list[tuple[str, str, dict[str, Any], dict[str, Any]]] = [
    ("bump", "golf-ball", {"replacement.entries": [64, 16], "brightness.bits": 6}, {"turn": (30.0, -10.0), "zoom": 1.5}),
    ("shade", "goblet@2", {"shade.mode": "normal", "shortcut.flatness.enabled": False}, {"light": (0.4, 0.8, 0.45)}),
    ("texel", "corridor", {"texel.error_bound": 0.25}, {"frames": 2, "orbit": 20.0}),
    ("defer", "gallery", {"defer.mode": "progressive"}, {}),
]


def options(view: dict[str, Any]) -> list[str]:
    def shown(value: Any) -> str:
        return ",".join(map(str, value)) if isinstance(value, tuple) else str(value)

    return [f"--{name.replace('_', '-')}={shown(value)}" for name, value in view.items()]


def settings(given: dict[str, Any]) -> list[str]:
    return [f"--set={key}={str(value).lower() if isinstance(value, bool) else value}" for key, value in given.items()]


@pytest.mark.parametrize(("machine", "demo", "given", "view"), RUNS, ids=[run[0] for run in RUNS])
def test_cycles_reports_and_pictures_are_those_of_the_program(
    program: Program, tmp_path: Path, machine: str, demo: str, given: dict[str, Any], view: dict[str, Any]
) -> None:
    done = program("demo", demo, "--machine", machine, "--size=80x60", *options(view), *settings(given), "--out", tmp_path, "--json")
    result = basrelief.Machine(machine, given).run(basrelief.demo(demo, size=(80, 60), **view))
    report = report_of(done)
    assert result.report == report
    assert result.cycles == sum(report["cycles"]["frames"]) > 0
    last = "-0002" if view.get("frames") == 2 else ""
    pictures = {"image": result.image, "reference": result.reference, "difference": result.difference}
    for kind, picture in pictures.items():
        assert picture.png() == (tmp_path / f"{kind}{last}.png").read_bytes(), kind


def test_a_model_and_a_display_list_are_those_of_the_program(program: Program, tmp_path: Path) -> None:
    camera = tmp_path / "camera.json"
    camera.write_text(json.dumps(program_camera(program, tmp_path)))
    done = program("run", PATCH, "--size=64x48", "--camera", camera, "--out", tmp_path, "--json")
    scene = basrelief.scene(PATCH, size=(64, 48), camera=camera)
    assert basrelief.Machine("bump").run(scene).report == report_of(done)
    done = program("run", TRACE, "--out", tmp_path, "--json")
    assert basrelief.Machine("bump").run(basrelief.display_list(TRACE)).report == report_of(done)


def program_camera(program: Program, folder: Path) -> Any:
    return report_of(program("run", PATCH, "--size=16x12", "--turn=20,10", "--out", folder, "--json"))["camera"]


@pytest.mark.parametrize(
    ("option", "given"),
    [
        (["--engine=ticked"], {"engine": "ticked"}),
        (["--functional"], {"engine": "functional"}),
        (["--no-exact"], {"exact": False}),
        (["--no-bottlenecks"], {"bottlenecks": False}),
        (["--bottlenecks"], {"bottlenecks": True}),
        (["--costs"], {"costs": True}),
    ],
)
def test_options_of_a_run_are_those_of_the_program(
    program: Program, tmp_path: Path, option: list[str], given: dict[str, Any]
) -> None:
    done = program("run", PATCH, "--size=48x36", "--out", tmp_path, "--json", *option)
    assert basrelief.Machine("bump").run(basrelief.scene(PATCH, size=(48, 36)), **given).report == report_of(done)


def test_a_configuration_from_a_file_is_that_of_the_program(program: Program, tmp_path: Path) -> None:
    config = tmp_path / "small.toml"
    config.write_text("[replacement]\nentries = 16\n[fifo.shaded]\ndepth = 8\n")
    options = ["--config", config, "--set", "fifo.shaded.depth=4"]
    done = program("demo", "--size=48x36", "--out", tmp_path, "--json", *options)
    machine = basrelief.Machine("bump", config, **{"fifo.shaded.depth": 4})
    assert machine.run(basrelief.demo("golf-ball", size=(48, 36))).report == report_of(done)
    described = json.loads(program("describe", "bump", "--json", *options).stdout)
    assert machine.describe()["key"] == [row["key"] for row in described]
    assert machine.describe()["value"] == [row["value"] for row in described]


def test_a_report_is_a_configuration(tmp_path: Path) -> None:
    machine = basrelief.Machine("shade", **{"shade.mode": "normal"})
    report = machine.run(basrelief.demo("ellipsoid@1", size=(16, 12)), exact=False).report
    for name, content in (("report.json", report), ("config.json", report["config"])):
        (tmp_path / name).write_text(json.dumps(content))
        assert basrelief.Machine("shade", tmp_path / name).describe()["value"] == machine.describe()["value"]
    with pytest.raises(basrelief.InputError, match="is a report of machine `shade`, and this is `bump`"):
        basrelief.Machine("bump", tmp_path / "report.json")


def test_a_page_a_text_and_a_comparison_are_those_of_the_program(program: Program, tmp_path: Path) -> None:
    machine, scene = basrelief.Machine("bump"), basrelief.demo("golf-ball", size=(64, 48))
    results = {}
    for entries in (16, 64):
        out = tmp_path / str(entries)
        done = program(
            "demo", "--size=64x48", f"--set=replacement.entries={entries}", "--out", out, "--html", tmp_path / "page.html"
        )
        assert done.returncode == 0, done.stderr
        result = results[entries] = machine.set({"replacement.entries": entries}).run(scene)
        assert result.html() == (tmp_path / "page.html").read_text()
        # Equal except for the speed of the host.
        assert set(str(result).splitlines()) <= set(done.stdout.splitlines())
        loaded = basrelief.load(out)
        assert loaded.report == result.report
        assert (loaded.image, loaded.reference) == (result.image, result.reference)
        assert loaded.recording.resimulate(bottlenecks=True).report == result.report
    done = program("compare", tmp_path / "16", tmp_path / "64", "--json")
    expected = json.loads(done.stdout)
    a, b = expected.pop("a"), expected.pop("b")
    comparison = results[16].compare(results[64], (a, b))
    assert comparison.report == expected
    assert not comparison.equal
    assert "memories" in comparison.changes["table"]
    assert str(comparison) == program("compare", tmp_path / "16", tmp_path / "64").stdout
    # The package gives the pictures of both sides the program's names, although it holds the pictures in memory.
    program("compare", tmp_path / "16", tmp_path / "64", "--html", tmp_path / "compared.html")
    assert comparison.html() == (tmp_path / "compared.html").read_text()
    assert results[16].compare(results[16]).equal


def test_saved_files_equal_those_of_the_program(program: Program, tmp_path: Path) -> None:
    done = program("demo", "--size=64x48", "--out", tmp_path / "program")
    assert done.returncode == 0, done.stderr
    result = basrelief.Machine("bump").run(basrelief.demo("golf-ball", size=(64, 48)))
    result.save(tmp_path / "package")
    names = sorted(path.name for path in (tmp_path / "program").iterdir())
    assert sorted(path.name for path in (tmp_path / "package").iterdir()) == names
    for name in names:
        of_program, of_package = (tmp_path / "program" / name).read_bytes(), (tmp_path / "package" / name).read_bytes()
        assert name == "report.json" or of_program == of_package, name
    assert program("compare", tmp_path / "program", tmp_path / "package").stdout.endswith("\nThe reports are equal, host figures aside.\n")


def test_timed_again_is_run() -> None:
    scene = basrelief.demo("golf-ball", size=(64, 48))
    machine = basrelief.Machine("bump", **{"replacement.entries": 64})
    result = machine.run(scene)
    times = {"fifo.shaded.depth": 2, "memory.graphics.part": "sdr-133"}
    again = result.recording.resimulate(times, bottlenecks=True)
    run = machine.set(times).run(scene)
    assert again.report == run.report != result.report
    # A resimulated recording can be resimulated again.
    assert again.recording.resimulate({"fifo.shaded.depth": 64}).report == run.recording.resimulate({"fifo.shaded.depth": 64}).report
