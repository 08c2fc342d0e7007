"""Compares the error messages of the package with those of the program."""

from __future__ import annotations

import pickle
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import basrelief
import pytest
from basrelief import InputError, Machine, UsageError
from conftest import ROOT, Program

PATCH = ROOT / "tests/models/patch.gltf"

# Options of the program, the equivalent call of the package, and the program's exit code.
WRONG: list[tuple[list[str], Callable[[], Any], int]] = [
    (["demo", "--set=replacement.entires=64"], lambda: Machine("bump", **{"replacement.entires": 64}), 2),
    (["demo", "--set=replacement.entries=0"], lambda: Machine("bump", **{"replacement.entries": 0}), 2),
    (["demo", "--set=replacement.entries=many"], lambda: Machine("bump", **{"replacement.entries": "many"}), 2),
    (["demo", "--set=shade.mode=normal"], lambda: Machine("bump", **{"shade.mode": "normal"}), 2),
    (["demo", "--set=replacement=1"], lambda: Machine("bump").set(replacement=1), 2),
    (["demo", "--set=cache.clut.line_bytes=48"], lambda: Machine("bump", {"cache.clut.line_bytes": 48}), 2),
    (["demo", "--config=none.toml"], lambda: Machine("bump", "none.toml"), 1),
    (["demo", "--config=bad.toml"], lambda: Machine("bump", "bad.toml"), 1),
    (["demo", "--config=unknown.toml"], lambda: Machine("bump", "unknown.toml"), 1),
    (["demo", "golfball"], lambda: basrelief.demo("golfball"), 2),
    (["run", "none.glb"], lambda: basrelief.scene("none.glb"), 1),
    (["run", "bad.gltf"], lambda: basrelief.scene("bad.gltf"), 1),
    (["run", "alone.gltf"], lambda: basrelief.scene("alone.gltf"), 1),
    (["serve", "text.txt"], lambda: basrelief.scene("text.txt"), 1),
    (["run", "none.jsonl"], lambda: basrelief.display_list("none.jsonl"), 1),
    (["run", "bad.jsonl"], lambda: Machine("bump").run(basrelief.display_list("bad.jsonl")), 1),
    (["run", str(PATCH), "--camera=bad.gltf"], lambda: basrelief.scene(PATCH, camera="bad.gltf"), 1),
    (["compare", "bad.gltf", "bad.gltf"], lambda: basrelief.load("bad.gltf"), 1),
]


@pytest.mark.parametrize(("options", "asked", "code"), WRONG, ids=[" ".join(wrong[0][-2:]) for wrong in WRONG])
def test_errors_have_the_words_of_the_program(
    program: Program,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    options: list[str],
    asked: Callable[[], Any],
    code: int,
) -> None:
    (tmp_path / "bad.toml").write_text("replacement = [")
    (tmp_path / "unknown.toml").write_text("[replacement]\nentires = 64\n")
    (tmp_path / "bad.gltf").write_text('{"asset": 7}')
    (tmp_path / "alone.gltf").write_text('{"asset":{"version":"2.0"},"buffers":[{"uri":"none.bin","byteLength":4}]}')
    (tmp_path / "text.txt").write_text("no model")
    (tmp_path / "bad.jsonl").write_text('{"begin":{"format":"basrelief-display-list","version":1,"width":0}}\n')
    monkeypatch.chdir(tmp_path)
    done = program(*options)
    with pytest.raises(basrelief.Error) as raised:
        asked()
    assert (done.returncode, str(raised.value) in done.stderr) == (code, True), f"{raised.value}\n{done.stderr}"
    assert raised.type is {1: InputError, 2: UsageError}[code]


def test_package_errors_are_sentences(tmp_path: Path) -> None:
    scene, machine = basrelief.demo("golf-ball", size=(16, 12)), Machine("bump")
    trace = ROOT / "traces/patch-one-level.jsonl"

    def says(words: str, asked: Callable[[], Any], kind: type[basrelief.Error] = UsageError) -> None:
        with pytest.raises(kind) as raised:
            asked()
        assert words in str(raised.value), str(raised.value)
        assert type(pickle.loads(pickle.dumps(raised.value))) is kind

    says("no machine is called `bmp`; expected bump, ", lambda: Machine("bmp"))
    says("`clock.hz`: None; expected a number", lambda: Machine("bump", **{"clock.hz": None}))
    says("size: -3; expected a whole number", lambda: basrelief.demo("golf-ball", size=(-3, 2)))
    says("engine: `fast`; expected timed", lambda: machine.run(scene, engine="fast"))  # type: ignore[arg-type]
    says("functional mode has no timing", lambda: machine.run(scene, engine="functional", recording=True))
    says("max_cycles: 0; expected 1 or more", lambda: machine.run(scene, max_cycles=0))
    says("basrelief.display_list opens it", lambda: basrelief.scene(trace))
    says("No such file or directory (os error 2); basrelief.demo opens a demo", lambda: basrelief.scene("goblet@8"), InputError)
    says("basrelief.scene opens a model", lambda: basrelief.display_list(PATCH))
    says("not a regular file", lambda: basrelief.display_list(tmp_path), InputError)
    says("frame: `arrow`; expected pandas or polars", lambda: machine.describe().frame("arrow"))
    says("give more with memory_limit", lambda: basrelief.scene(PATCH, memory_limit=1000), InputError)
    result = machine.run(scene, exact=False, bottlenecks=False, engine="functional")
    says("functional mode has no timing", lambda: result.cycles, basrelief.Error)
    says("run(bottlenecks=True)", lambda: result.bottlenecks, basrelief.Error)
    says("run(recording=True)", lambda: result.recording, basrelief.Error)
    says("run(exact=True)", lambda: result.reference, basrelief.Error)
    recording = machine.run(scene).recording
    says("`replacement.entries` changes the work of the units", lambda: recording.resimulate({"replacement.entries": 64}))
    says("no image", lambda: recording.resimulate().image, basrelief.Error)
    says("not a recording", lambda: basrelief.Recording(b"none").resimulate(), InputError)


def test_missing_library_of_data_frames_names_its_cure(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "polars", None)
    with pytest.raises(ModuleNotFoundError, match=r"frame: .*polars.*; install polars, for example with `pip install polars`"):
        Machine("bump").describe().frame("polars")


@pytest.mark.parametrize("option", ["timeline", "waves", "tokens", "requests"])
def test_missing_folder_is_named_as_by_the_program(
    program: Program, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, option: str
) -> None:
    monkeypatch.chdir(tmp_path)
    done = program("demo", "golf-ball", "--size=16x12", f"--{option}=none/a")
    files: Any = {option: "none/a"}
    with pytest.raises(InputError) as raised:
        Machine("bump").run(basrelief.demo("golf-ball", size=(16, 12)), **files)
    assert done.stderr == f"error: {raised.value}\n"
    assert str(raised.value).startswith("none/a: cannot be written: "), raised.value
    assert str(raised.value).endswith("; create the folder none first"), raised.value


def test_wrong_arguments_are_named_with_their_expectation(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    machine: Any = Machine("bump")
    demo: Any = basrelief.demo
    scene = demo("golf-ball", size=(16, 12))
    ran = machine.run(scene, exact=False)
    recording: Any = ran.recording
    image: Any = ran.image
    opened: Any = basrelief.scene
    wrong: list[tuple[str, Callable[[], Any]]] = [
        ("scene: 'golf-ball'; expected the result of basrelief.demo", lambda: machine.run("golf-ball")),
        ("scene: None; expected the result of", lambda: machine.ablate(None)),
        ("scene: 7; expected the result of", lambda: machine.record(7, "a.jsonl")),
        ("name: 7; expected a string", lambda: Machine(7)),  # type: ignore[arg-type]
        ("name: None; expected a string", lambda: demo(None)),
        ("config: 7; expected a path", lambda: Machine("bump", 7)),  # type: ignore[arg-type]
        ("given: 3; expected a mapping from keys to values", lambda: machine.set(3)),
        ("given: {3: 4}; expected a mapping", lambda: machine.set({3: 4})),
        ("given: 7; expected a mapping", lambda: recording.resimulate(7)),
        ("other: 'x'; expected a Result", lambda: recording.resimulate().compare("x")),
        ("names: ('A',); expected two strings", lambda: recording.resimulate().compare(recording.resimulate(), ("A",))),
        ("client: 42; expected a client of Dask distributed", lambda: basrelief.sweep("plan.toml", 42)),
        ("`clock.hz`: [1]; expected a number, a boolean, a string or a list", lambda: machine.set({"clock.hz": [[1]]})),
        ("path: 'a.jpg'; expected a name that ends in .png, the format that is written", lambda: image.save("a.jpg")),
        ("waves: 'x.vcd'; expected a name that ends in .fst, the format", lambda: machine.run(scene, waves="x.vcd")),
        ("path: 7; expected a path", lambda: opened(7)),
        ("camera: 7; expected a path", lambda: opened("a.glb", camera=7)),
        ("size: '64x48'; expected width and height", lambda: demo("golf-ball", size="64x48")),
        ("size: 0; expected a whole number from 1 on", lambda: demo("golf-ball", size=(0, 12))),
        ("turn: (1,); expected 2 numbers", lambda: demo("golf-ball", turn=(1,))),
        ("light: 'up'; expected 3 numbers", lambda: demo("golf-ball", light="up")),
        ("zoom: 'big'; expected a number", lambda: demo("golf-ball", zoom="big")),
        ("zoom: 0; expected a number from 0.01 to 100", lambda: demo("golf-ball", zoom=0)),
        ("frames: 1.5; expected a whole number", lambda: demo("golf-ball", frames=1.5)),
        ("memory_limit: -1; expected a whole number", lambda: demo("golf-ball", memory_limit=-1)),
        ("max_cycles: 'many'; expected a whole number", lambda: machine.run(scene, max_cycles="many")),
        ("max_cycles: -5; expected a whole number", lambda: machine.run(scene, max_cycles=-5)),
        ("engine: None; expected a string", lambda: machine.run(scene, engine=None)),
        ("exact: 'yes'; expected True or False", lambda: machine.run(scene, exact="yes")),
        ("timeline: 7; expected a path", lambda: machine.run(scene, timeline=7)),
        ("waves: ", lambda: machine.run(scene, timeline="a", waves="./a")),
        ("units: 'brightness'; expected a list of strings", lambda: machine.run(scene, timeline="a", units="brightness")),
        ("units: no unit of bump is called `brigthness`; did you mean `brightness`", lambda: machine.run(scene, timeline="a", units=["brigthness"])),
        ("from_cycle, to_cycle, units: select a part of timeline", lambda: machine.run(scene, from_cycle=5)),
        ("from_cycle: 5 is not before to_cycle 5", lambda: machine.run(scene, timeline="a", from_cycle=5, to_cycle=5)),
        ("tokens_of: `pixels`; expected fragments or polygons", lambda: machine.run(scene, tokens="a", tokens_of="pixels")),
        ("tokens_every: 0; expected a whole number from 1 on", lambda: machine.run(scene, tokens="a", tokens_every=0)),
        ("requests_format: `dram`; expected csv, dramsim3", lambda: machine.run(scene, requests="a", requests_format="dram")),
        ("requests_memory: machine `bump` has no memory `ram`", lambda: machine.run(scene, requests="a", requests_memory="ram")),
        ("no timing; remove sensitivity, waves", lambda: machine.run(scene, engine="functional", sensitivity=True, waves="a")),
        ("a.txt: the file name selects the form of a trace", lambda: machine.record(scene, "a.txt")),
        ("content: 'x'; expected bytes", lambda: basrelief.Recording("x")),  # type: ignore[arg-type]
        ("bottlenecks: 1; expected True or False", lambda: recording.resimulate(bottlenecks=1)),
        ("recordings: [7]; expected a recording", lambda: basrelief.size_fifos([7])),  # type: ignore[list-item]
        ("within: 'a'; expected a number", lambda: basrelief.size_fifos(recording, "a")),  # type: ignore[arg-type]
        ("plan: 7; expected a path", lambda: basrelief.sweep(7)),  # type: ignore[arg-type]
        ("threads: 0; expected a whole number from 1 on", lambda: basrelief.sweep("plan.toml", threads=0)),
        ("seed: 4294967296; expected a whole number of at most 32 bits", lambda: _explore(tmp_path, seed=1 << 32)),
        ("expected `budget`, a number of points, or `seconds`", lambda: _explore(tmp_path)),
    ]
    for words, asked in wrong:
        with pytest.raises(UsageError) as raised:
            asked()
        assert words in str(raised.value), f"{raised.value}, expected {words}"
    assert [path.name for path in tmp_path.iterdir()] == ["plan.toml"]


def _explore(folder: Path, **options: Any) -> Any:
    plan = folder / "plan.toml"
    plan.write_text('input = "demo:golf-ball"\nobjectives = ["cycles min"]\n[axes]\nreplacement.entries = [16, 64]\n')
    return basrelief.explore(plan, out=folder / "points", **options)


def test_exceptions_belong_to_the_module_they_are_imported_from() -> None:
    for name in basrelief.__all__:
        kind = getattr(basrelief, name)
        if isinstance(kind, type) and issubclass(kind, Exception):
            assert (kind.__module__, kind.__qualname__) == ("basrelief", name)
    assert issubclass(basrelief.IncompleteError, basrelief.Error)


def test_incomplete_run_keeps_its_report(program: Program, tmp_path: Path) -> None:
    with pytest.raises(basrelief.IncompleteError) as raised:
        Machine("bump").run(basrelief.demo("golf-ball", size=(32, 24)), max_cycles=1000)
    assert str(raised.value).startswith("stopped at max_cycles")
    assert raised.value.result.cycles == 1000
    assert raised.value.result.report["outcome"]["kind"] == "limit"
    again = pickle.loads(pickle.dumps(raised.value))
    assert (str(again), again.result.report) == (str(raised.value), raised.value.result.report)
