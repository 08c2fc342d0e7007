"""Compares the error messages of the package with those of the program."""

from __future__ import annotations

import pickle
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
    (["demo", "golf-ball", "--zoom=0"], lambda: basrelief.demo("golf-ball", zoom=0), 2),
    (["run", "none.glb"], lambda: basrelief.scene("none.glb"), 1),
    (["run", "bad.gltf"], lambda: basrelief.scene("bad.gltf"), 1),
    (["run", "alone.gltf"], lambda: basrelief.scene("alone.gltf"), 1),
    (["run", "text.txt"], lambda: basrelief.scene("text.txt"), 1),
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


def test_incomplete_run_keeps_its_report(program: Program, tmp_path: Path) -> None:
    with pytest.raises(basrelief.IncompleteError) as raised:
        Machine("bump").run(basrelief.demo("golf-ball", size=(32, 24)), max_cycles=1000)
    assert str(raised.value).startswith("stopped at max_cycles")
    assert raised.value.result.cycles == 1000
    assert raised.value.result.report["outcome"]["kind"] == "limit"
    again = pickle.loads(pickle.dumps(raised.value))
    assert (str(again), again.result.report) == (str(raised.value), raised.value.result.report)
