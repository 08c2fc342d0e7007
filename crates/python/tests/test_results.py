"""Tests of tables, pictures and pickles."""

from __future__ import annotations

import hashlib
import io
import os
import pickle
import shutil
import subprocess
import sys
from pathlib import Path

import basrelief
import numpy
import pandas
import polars
import pytest
from basrelief import InputError, Machine, Result, Table
from conftest import ROOT
from pandas.api.types import is_numeric_dtype
from PIL import Image


@pytest.fixture(scope="module")
def result() -> Result:
    return Machine("bump", **{"replacement.entries": 64}).run(basrelief.demo("golf-ball", size=(64, 48)))


def test_cycles_of_every_unit_sum_to_the_run(result: Result) -> None:
    units = result.units.frame()
    columns = ["busy", "starved", "blocked", "memory", "done"]
    assert (units[columns].sum(axis=1) == result.report["cycles"]["total"]).all()
    assert list(units["unit"]) == list(result.report["units"])


def test_tables_are_frames_of_pandas_and_polars(result: Result) -> None:
    texts = {"units": {"unit"}, "fifos": {"fifo"}, "memories": {"memory", "client"}, "caches": {"cache"}}
    for name in ("units", "fifos", "memories", "caches", "bottlenecks", "ladder", "figures"):
        table: Table = getattr(result, name)
        rows = len(table.rows())
        assert rows > 0 and all(len(column) == rows for column in table.values()), name
        assert table.frame("polars").shape == (rows, len(table))
        if name != "figures":  # The values of `figures` are numbers, texts and lists.
            assert polars.DataFrame(table).shape == (rows, len(table))
        if name in texts:
            kinds = table.frame().dtypes.items()
            assert all(is_numeric_dtype(kind) for column, kind in kinds if column not in texts[name]), name
        assert pandas.DataFrame(table).shape == (rows, len(table)) == table.frame().shape
        assert table._repr_html_().count("<tr>") == rows + 1
    fifos = result.fifos
    assert all(0 <= mean <= high <= depth for mean, high, depth in zip(*(fifos[n] for n in ("mean", "high_water", "depth"))))
    bytes_moved = sum(result.memories["read_bytes"]) + sum(result.memories["write_bytes"])
    assert bytes_moved == sum(
        client["read_bytes"] + client["write_bytes"]
        for memory in result.report["memories"].values()
        for client in memory["clients"].values()
    )


def test_every_table_is_a_frame_of_polars() -> None:
    scene = basrelief.demo("golf-ball", size=(16, 12))
    machine, texel = Machine("bump"), Machine("texel")
    result = machine.run(scene, sensitivity=True, bottlenecks=True, recording=True)
    other = machine.set({"replacement.lanes": 1}).run(scene, recording=True)
    tables = {name: getattr(result, name) for name in ("units", "fifos", "memories", "caches", "bottlenecks", "ladder", "figures")}
    tables |= {"sensitivity": result.sensitivity, "changes": result.compare(other).changes, "demos": basrelief.demos()}
    tables |= {f"{name}.describe": Machine(name).describe() for name in basrelief.machines()}
    tables |= {"ablate": Machine("shade").ablate(scene), "methods": texel.compare_methods(scene)}
    for name, table in tables.items():
        frame = table.frame("polars")
        assert frame.shape == (len(table.rows()), len(table)) == table.frame().shape, name
    assert machine.describe().frame("polars")["value"].dtype == polars.String
    assert result.units.frame("polars")["busy"].dtype == polars.Int64
    assert Table({"a": [1, 2.5, None]}).frame("polars")["a"].to_list() == [1.0, 2.5, None]
    assert Table({"a": [1, "x", None, [2]]}).frame("polars")["a"].to_list() == ["1", "x", None, "[2]"]


def test_arrays_of_numpy_are_parameters() -> None:
    machine, key = Machine("defer", **{"defer.mode": "progressive"}), "defer.left_at_ms"
    assert machine.set({key: numpy.array([1.0, 2.0])}) == machine.set({key: [1.0, 2.0]})
    assert Machine("bump", **{"replacement.lanes": numpy.int64(2)}) == Machine("bump", **{"replacement.lanes": 2})


def test_data_libraries_are_loaded_on_demand() -> None:
    script = "import sys, basrelief; basrelief.Machine('bump').describe(); print({'pandas', 'polars', 'numpy'} & set(sys.modules))"
    assert subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout == "set()\n"


def test_a_picture_is_an_array_without_a_copy(result: Result) -> None:
    picture = result.image
    array = numpy.asarray(picture)
    assert array.shape == (48, 64, 4) and array.dtype == numpy.uint8
    assert numpy.shares_memory(array, numpy.frombuffer(picture.tobytes(), numpy.uint8))
    assert hashlib.sha256(array[..., :3].tobytes()).hexdigest() == result.report["image"][-1]["sha256"]
    with Image.open(io.BytesIO(picture.png())) as image:
        assert (numpy.asarray(image) == array).all()
    assert picture._repr_png_() == picture.png() == result._repr_png_()
    assert Image.fromarray(picture).size == picture.size == (64, 48)


def test_notebook_shows_result_and_keeps_its_own_style(result: Result) -> None:
    html = result._repr_html_()
    for part in ("Bottlenecks", "Block diagram", "Cycle breakdown", "data:image/png;base64,"):
        assert part in html, part
    parts = [html.index(part) for part in ("gate equivalents", "data:image/png;base64,", "Bottleneck ladder", "Block diagram")]
    assert parts == sorted(parts), "key figures, pictures, bottlenecks, then the rest"
    style = html.partition("<style>")[2].partition("</style>")[0]
    assert style.startswith(".basrelief.basrelief.basrelief {"), "outranks the rules of JupyterLab for tables and lists"
    assert not any(line.startswith((":root", "body")) for line in style.splitlines())
    assert style.count("{") == style.count("}")


def test_files_are_written_whole_or_not_at_all(result: Result, tmp_path: Path) -> None:
    result.save(tmp_path / "a" / "b")
    assert basrelief.load(tmp_path / "a" / "b").report == result.report
    with pytest.raises(InputError) as raised:
        result.image.save(tmp_path / "none" / "image.png")
    assert str(raised.value).startswith(f"{tmp_path / 'none/image.png'}: cannot be written: ")
    assert str(raised.value).endswith(f"; create the folder {tmp_path / 'none'} first")
    with pytest.raises(InputError, match="a: cannot be written: "):
        result.image.save(tmp_path / "a")
    assert [path.name for path in tmp_path.iterdir()] == ["a"]
    result.image.save(tmp_path / "image.png")
    plain = tmp_path / "plain"
    plain.touch()
    assert (tmp_path / "image.png").stat().st_mode == plain.stat().st_mode


def test_loaded_result_has_the_saved_images(result: Result, tmp_path: Path) -> None:
    result.save(tmp_path / "a")
    loaded = basrelief.load(tmp_path / "a")
    assert (loaded.image, loaded.reference, loaded.difference) == (result.image, result.reference, result.difference)
    loaded.save(tmp_path / "b")
    files = {path.name: path.read_bytes() for path in (tmp_path / "a").iterdir()}
    assert files == {path.name: path.read_bytes() for path in (tmp_path / "b").iterdir()} and "difference.png" in files
    # Saved runs of several frames have the images of the last frame.
    several = Machine("bump").run(basrelief.demo("golf-ball", size=(16, 12), frames=2, orbit=30))
    several.save(tmp_path / "several")
    assert basrelief.load(tmp_path / "several").image == several.image
    several.image.save(tmp_path / "a" / "image.png")
    with pytest.raises(InputError, match=r"image\.png: is not the image of report\.json beside it; remove the file"):
        basrelief.load(tmp_path / "a")
    (tmp_path / "a" / "image.png").write_bytes(b"none")
    with pytest.raises(InputError, match=r"image\.png: neither PNG nor JPEG"):
        basrelief.load(tmp_path / "a")
    (tmp_path / "a" / "image.png").unlink()
    with pytest.raises(basrelief.Error, match="a loaded folder may lack it"):
        basrelief.load(tmp_path / "a").image


def test_pickled_objects_are_restored(result: Result) -> None:
    again = pickle.loads(pickle.dumps(result))
    assert (again.report, again.image, again.reference, again.recording) == (
        result.report,
        result.image,
        result.reference,
        result.recording,
    )
    machine = Machine("shade", **{"shade.mode": "normal"})
    assert pickle.loads(pickle.dumps(machine)) == machine != Machine("shade")
    assert hash(pickle.loads(pickle.dumps(machine))) == hash(machine)


def test_pickled_machines_and_scenes_need_no_files(tmp_path: Path) -> None:
    for name in ("patch.gltf", "patch.obj", "patch.mtl", "bumps.png", "checks.png"):
        shutil.copy(ROOT / "tests/models" / name, tmp_path)
    (tmp_path / "machine.toml").write_text("[replacement]\nentries = 16\n")
    machine = Machine("bump", tmp_path / "machine.toml")
    view = {"size": (48, 36), "frames": 2, "orbit": 30.0}
    scenes = [basrelief.scene(tmp_path / name, **view) for name in ("patch.gltf", "patch.obj")]  # type: ignore[arg-type]
    scenes.append(basrelief.demo("goblet@2", **view))  # type: ignore[arg-type]
    reports = [machine.run(scene).report for scene in scenes]
    pickled = pickle.dumps((machine, scenes))
    shutil.rmtree(tmp_path)
    # A separate process, as in a worker.
    script = "import pickle, sys; m, s = pickle.load(sys.stdin.buffer); sys.stdout.buffer.write(pickle.dumps([m.run(x).report for x in s]))"
    done = subprocess.run([sys.executable, "-c", script], input=pickled, capture_output=True, check=True)
    assert pickle.loads(done.stdout) == reports
    machine, scenes = pickle.loads(pickled)
    assert [scene.size for scene in scenes] == [(48, 36)] * 3
    assert [repr(scene).partition("(")[2] for scene in scenes][2] == '"goblet@2", 48 x 36, 2 frames)'


def test_a_display_list_pickles_as_its_path(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(ROOT / "traces")
    trace = basrelief.display_list("patch-one-level.jsonl")
    monkeypatch.chdir(tmp_path)
    machine = Machine("bump")
    assert machine.run(pickle.loads(pickle.dumps(trace))).report == machine.run(trace).report


def test_names_are_listed() -> None:
    assert list(basrelief.machines()) == ["bump", "shade", "texel", "defer"]
    demos = basrelief.demos()
    assert set(demos["machine"]) == set(basrelief.machines())
    assert "golf-ball" in demos["name"]
    described = Machine("bump", **{"replacement.entries": 64}).describe()
    row = next(row for row in described.rows() if row["key"] == "replacement.entries")
    assert (row["value"], row["default"], row["effect"], row["provenance"]) == (64, 256, "work", row["provenance"])
    assert set(described["provenance"]) == {"stated", "derived", "assumed"}
    assert os.path.exists(os.path.join(os.path.dirname(basrelief.__file__), "py.typed"))
