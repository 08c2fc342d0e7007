"""Results of runs."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

from . import _basrelief, arguments
from ._basrelief import Error, InputError
from .comparison import Comparison
from .files import FilePath, write
from .picture import Picture
from .renamed import warn_renamed
from .settings import Settings, settings
from .table import Table

REPORT = "report.json"
RECORDING = "run.recording"
# Name from before version 0.2.
OLD_RECORDING = "run.tape"


class IncompleteError(Error):
    """A deadlock, or a stop at `max_cycles`. `result` holds the report so far."""

    __module__ = "basrelief"

    def __init__(self, message: str, result: Result) -> None:
        super().__init__(message, result)
        self.message = message
        self.result = result

    def __str__(self) -> str:
        return self.message


class Recording:
    """The steps of a run, without their times."""

    __slots__ = ("_bytes",)

    def __init__(self, content: bytes) -> None:
        if not isinstance(content, bytes):
            raise arguments.wrong("content", content, "bytes; Result.recording is a recording")
        self._bytes = content

    def resimulate(
        self,
        given: Mapping[str, Any] | None = None,
        /,
        *,
        bottlenecks: bool | None = False,
        recording: bool = False,
        memory_limit: int | None = None,
        **parameters: Any,
    ) -> Result:
        """Computes the timing anew with these parameters changed, without executing the units again.

        `bottlenecks`: analyse bottlenecks; `None` only if the recording is short.
        `recording`: keep the recording at once. Otherwise `Result.recording` makes it when it is first used.
        `memory_limit`: as in `Machine.run`.
        Raises `UsageError` for a work parameter; timing and cost parameters may change. `Machine.describe()["effect"]`
        has the effect of each parameter.
        """
        analysed = None if bottlenecks is None else arguments.truth("bottlenecks", bottlenecks)
        limit = None if memory_limit is None else arguments.whole("memory_limit", memory_limit)
        changes = settings(given, parameters)
        ran = _basrelief.resimulate(self._bytes, changes, (analysed, arguments.truth("recording", recording)), limit)
        result = result_of(ran)
        if result._recording is None:
            result._origin = (self._bytes, changes, limit)
        return result

    def retime(
        self,
        given: Mapping[str, Any] | None = None,
        /,
        *,
        limits: bool | None = None,
        tape: bool = False,
        memory_limit: int | None = None,
        **parameters: Any,
    ) -> Result:
        """Old name of `resimulate`."""
        warn_renamed("retime", "resimulate")
        return self.resimulate({**(given or {}), **parameters}, bottlenecks=limits, recording=tape, memory_limit=memory_limit)

    def save(self, path: FilePath) -> None:
        """Writes the recording as a file, as `--recording` does."""
        write(path, self._bytes)

    def __len__(self) -> int:
        """Returns the size [bytes]."""
        return len(self._bytes)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Recording) and self._bytes == other._bytes

    def __hash__(self) -> int:
        return hash(self._bytes)

    def __repr__(self) -> str:
        return f"Recording({len(self):,} bytes)"


class Result:
    """Result of a run: report, images and recording."""

    def __init__(self, text: str, image: Picture | None, reference: Picture | None, recording: Recording | None) -> None:
        self._text = text
        self._image = image
        self._reference = reference
        self._recording = recording
        # Of a resimulation: the recording, the changed parameters and the memory limit.
        self._origin: tuple[bytes, Settings, int | None] | None = None

    def __getstate__(self) -> tuple[Any, ...]:
        return self._text, self._image, self._reference, self._recording, self._origin

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        self._text, self._image, self._reference, self._recording, self._origin = state

    @cached_property
    def report(self) -> dict[str, Any]:
        """The report as in `report.json`, without the figures of the host."""
        report: dict[str, Any] = json.loads(self._text)
        return report

    def _part(self, name: str, advice: str) -> Any:
        if name not in self.report:
            raise Error(f"the report has no {name}: {advice}")
        return self.report[name]

    def _timed(self, name: str) -> Any:
        return self._part(name, "functional mode has no timing; use another engine")

    @property
    def cycles(self) -> int:
        """Render cycles; `report["cycles"]["total"]` also counts the write tail. For an incomplete run, all cycles."""
        cycles = self._timed("cycles")
        return sum(cycles["frames"]) if self.report["outcome"]["kind"] == "complete" and cycles["frames"] else int(cycles["total"])

    @property
    def units(self) -> Table:
        """Cycle breakdown of each unit, in the order of the block diagram. Stalls are summed; `report["units"]` has them per FIFO and
        client."""
        return Table.of_rows([{"unit": name, **_summed(unit)} for name, unit in self._timed("units").items()], _UNITS)

    @property
    def fifos(self) -> Table:
        """Occupancy of each FIFO: depth, tokens, high-water mark, mean over the render cycles, and cycles in which it was full."""
        cycles, is_complete = self._timed("cycles"), self.report["outcome"]["kind"] == "complete"
        tail = cycles["write_tail"] if is_complete and cycles["frames"] else 0
        return Table.of_rows([_fifo(name, fifo, tail) for name, fifo in self._timed("fifos").items()])

    @property
    def memories(self) -> Table:
        """Traffic and latency of each client of each memory."""
        memories = self._timed("memories").items()
        clients = [(name, *client) for name, memory in memories for client in memory["clients"].items()]
        return Table.of_rows([{"memory": memory, "client": name, **_plain(client)} for memory, name, client in clients])

    @property
    def caches(self) -> Table:
        """Look-ups, hits and misses of each cache."""
        return Table.of_rows([{"cache": name, **cache} for name, cache in self._timed("caches").items()])

    @property
    def bottlenecks(self) -> Table:
        """Measured bottlenecks: resource, relaxation, the parameters that relax it, the render cycles then, and the saving."""
        return Table.of_rows(self._bottlenecks()["single"], ["resource", "relaxation", "set", "cycles", "saved"])

    @property
    def ladder(self) -> Table:
        """Bottleneck ladder: all relaxed resources of each rung, the parameters, the render cycles then, and the saved share."""
        return Table.of_rows(self._bottlenecks()["ladder"], ["relaxed", "set", "cycles", "saved"])

    def _bottlenecks(self) -> Any:
        return self._part("bottlenecks", "run(bottlenecks=True) analyses every complete run")

    @property
    def limits(self) -> Table:
        """Old name of `bottlenecks`."""
        warn_renamed("Result.limits", "Result.bottlenecks")
        return self.bottlenecks

    @property
    def figures(self) -> Table:
        """Counted and derived figures, bytes and area: name, value, unit of measure and description."""
        legend = self.report["legend"]
        counted = [{"figure": name, "value": value, **legend.get(name, {})} for name, value in self.report["figures"].items()]
        derived = [
            {"figure": name, "value": of["value"], "unit": of["unit"], "description": of["formula"]}
            for name, of in self.report["derived"].items()
        ]
        return Table.of_rows(counted + derived + _sums(self.report), ["figure", "value", "unit", "description"])

    def figure(self, name: str) -> int | float:
        """Returns a figure by any name that a plan may use, for example `hardware.area_ge` or `units.geometry.busy`. Raises `UsageError`
        for an unknown name."""
        return _basrelief.figure(self._text, arguments.word("name", name))

    @property
    def sensitivity(self) -> Table:
        """Effect of each assumed parameter, largest first: parameter, description, unit of measure, old and new value, and the measures
        with their changes, or the reason why there are none."""
        changes = self._part("sensitivity", "run(sensitivity=True) measures it")["changes"]
        return Table.of_rows(changes)

    @property
    def image(self) -> Picture:
        """Image of the last frame."""
        if self._image is None:
            raise Error("there is no image: a resimulation draws none, a loaded folder may lack it, or the run stopped before its first frame")
        return self._image

    @property
    def reference(self) -> Picture:
        """Reference image of the last frame."""
        if self._reference is None:
            raise Error("there is no reference image; run(exact=True) computes it, and load(folder) reads that of a saved run")
        return self._reference

    @property
    def difference(self) -> Picture:
        """Difference of image and reference image, as the command line writes it."""
        return Picture(*_basrelief.difference(self.reference._pixels, self.image._pixels))

    @property
    def tape(self) -> Recording:
        """Old name of `recording`."""
        warn_renamed("Result.tape", "Result.recording")
        return self.recording

    @property
    def recording(self) -> Recording:
        """The steps of the run, without times."""
        kept = self._kept_recording()
        if kept is None:
            raise Error("no recording was kept; run(recording=True) keeps that of every complete run")
        return kept

    def _kept_recording(self) -> Recording | None:
        """Returns the recording, made anew for a resimulation."""
        if self._recording is None and self._origin is not None:
            content, changes, limit = self._origin
            made = _basrelief.resimulate(content, changes, (False, True), limit)["recording"]
            self._recording = None if made is None else Recording(made)
        return self._recording

    def compare(self, other: Result, names: tuple[str, str] = ("A", "B")) -> Comparison:
        """Compares this run with another. If both have recordings, the causes of the cycle difference are measured."""
        if not isinstance(other, Result):
            raise arguments.wrong("other", other, "a Result")
        sides = arguments.words("names", names)
        if len(sides) != 2:
            raise arguments.wrong("names", names, "two strings")
        return Comparison(self._side(sides[0]), other._side(sides[1]))

    def _side(self, name: str) -> _basrelief._Side:
        image, recording = self._image, self._kept_recording()
        pixels = None if image is None else image._pixels
        return {"name": name, "report": self._text, "image": pixels, "recording": None if recording is None else recording._bytes}

    def html(self) -> str:
        """Returns the report as an HTML page, as `--html` writes it."""
        return _basrelief.page(self._text, self._shown())

    def _shown(self) -> tuple[_basrelief._Pixels | None, _basrelief._Pixels | None]:
        image, reference = self._image, self._reference
        return None if image is None else image._pixels, None if reference is None else reference._pixels

    def save_html(self, path: FilePath) -> None:
        """Writes the report as an HTML page."""
        write(path, self.html().encode())

    def save(self, folder: FilePath) -> None:
        """Writes images, recording and report into a folder, as `--out` does. `basrelief compare` and `load` read them. The report is
        written last."""
        place = Path(folder)
        place.mkdir(parents=True, exist_ok=True)
        (place / REPORT).unlink(missing_ok=True)
        pictures = [("image", self._image), ("reference", self._reference)]
        for kind, picture in pictures + [("difference", self.difference if self._reference else None)]:
            if picture is not None:
                picture.save(place / f"{kind}.png")
        for name in (RECORDING, OLD_RECORDING):
            (place / name).unlink(missing_ok=True)
        recording = self._kept_recording()
        if recording is not None:
            recording.save(place / RECORDING)
        write(place / REPORT, self._text.encode())

    def __str__(self) -> str:
        return _basrelief.text(self._text)

    def __repr__(self) -> str:
        report = self.report
        took = f"{self.cycles:,} cycles" if "cycles" in report else "no time"
        return f"Result({report['machine']}, {report['input']['name']}, {took})"

    def _repr_html_(self) -> str:
        return _basrelief.part(self._text, self._shown())

    def _repr_png_(self) -> bytes | None:
        return None if self._image is None else self._image.png()


def result_of(ran: _basrelief._Ran) -> Result:
    """Returns the result. Raises `IncompleteError` for an incomplete run."""
    recording = ran["recording"]
    result = Result(ran["report"], _picture(ran["image"]), _picture(ran["reference"]), None if recording is None else Recording(recording))
    outcome = result.report["outcome"]
    if outcome["kind"] == "complete":
        return result
    limit = "stopped at max_cycles; the report holds the state so far"
    raise IncompleteError(limit if outcome["kind"] == "limit" else outcome.get("message", outcome["kind"]), result)


def _picture(pixels: _basrelief._Pixels | None) -> Picture | None:
    return None if pixels is None else Picture(*pixels)


def load(path: FilePath) -> Result:
    """Loads a run from a folder written by `--out` or `Result.save`: the report, the recording, and the images of the last frame, if they
    are there. A report file with another name is loaded alone. Raises `InputError` for a file that cannot be read, and for
    an image of another run."""
    place = Path(path)
    report = place / REPORT if place.is_dir() else place
    text = _basrelief.read_report(str(report), _basrelief.read_text(report))
    if report.name != REPORT:
        return Result(text, None, None, None)
    image, reference = _saved_pictures(report.parent, json.loads(text)["image"])
    recording = next((place for name in (RECORDING, OLD_RECORDING) if (place := report.with_name(name)).exists()), None)
    if recording is None:
        return Result(text, image, reference, None)
    try:
        return Result(text, image, reference, Recording(recording.read_bytes()))
    except OSError as error:
        raise InputError(f"{recording}: cannot be read: {error.strerror}") from error


def _saved_pictures(folder: Path, listed: list[dict[str, str]]) -> tuple[Picture | None, Picture | None]:
    """Returns image and reference image of the last frame, if they are in the folder of their report."""
    if not listed:
        return None, None
    # A name alone, because a report of unknown origin must not select other files. `Result.save` writes the last frame only.
    names = (Path(listed[-1]["file"]).name, "image.png")
    file = next((file for name in names if name and (file := folder / name).is_file()), None)
    if file is None:
        return None, None
    image = Picture(*_basrelief.read_png(file))
    if image._sha256() != listed[-1]["sha256"]:
        raise InputError(f"{file}: is not the image of {REPORT} beside it; remove the file, or save the run again")
    reference = file.with_name(file.name.replace("image", "reference", 1))
    return image, Picture(*_basrelief.read_png(reference)) if reference.is_file() else None


_UNITS = ["unit", "numeral", "steps", "tokens", "busy", "starved", "blocked", "memory", "done"]


def _sums(report: dict[str, Any]) -> list[dict[str, Any]]:
    """Bytes of all memories and area of the machine, with the names that plans use."""
    about = {"requested": "Bytes that clients requested", "moved": "Bytes of whole bursts that the buses transferred"}
    sums = [(f"bytes.{name}", n, "bytes", about[name]) for name, n in report.get("bytes", {}).items()]
    area = {
        "area_ge": ("gate equivalents", "Area of the machine"),
        "logic_ge": ("gate equivalents", "Its logic"),
        "register_bits": ("bits", "Its flip-flops"),
        "memory_bits": ("bits", "Its memory macros"),
    }
    for key, (unit, text) in area.items():
        sums.append((f"hardware.{key}", sum(piece.get(key, 0) for piece in report["hardware"]), unit, text))
    return [dict(zip(("figure", "value", "unit", "description"), row)) for row in sums]


def _summed(unit: dict[str, Any]) -> dict[str, Any]:
    return {name: sum(value.values()) if isinstance(value, dict) else value for name, value in unit.items()}


def _fifo(name: str, fifo: dict[str, Any], tail: int) -> dict[str, Any]:
    """A FIFO that is empty in the `tail` after the last frame has its mean over the render cycles."""
    histogram = list(fifo["histogram"])
    if histogram[0] >= tail:
        histogram[0] -= tail
    held = sum(slots * cycles for slots, cycles in enumerate(histogram))
    figures = {"mean": held / max(sum(histogram), 1), "full": histogram[-1]}
    return {"fifo": name, **_plain(fifo), **figures}


def _plain(part: dict[str, Any]) -> dict[str, Any]:
    """Returns the entries that are no lists."""
    return {name: value for name, value in part.items() if not isinstance(value, list)}
