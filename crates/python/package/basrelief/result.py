"""What a run comes to."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

from . import _basrelief
from ._basrelief import Error, InputError
from .comparison import Comparison
from .files import FilePath, write
from .picture import Picture
from .settings import settings
from .table import Table

REPORT = "report.json"
TAPE = "run.tape"


class IncompleteError(Error):
    """A run that did not come to its end: a deadlock, or the limit of `max_cycles`. `result` holds the report so far."""

    def __init__(self, message: str, result: Result) -> None:
        super().__init__(message, result)
        self.message = message
        self.result = result

    def __str__(self) -> str:
        return self.message


class Tape:
    """The work of a run, without its times."""

    __slots__ = ("_bytes",)

    def __init__(self, content: bytes) -> None:
        self._bytes = content

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
        """What the run comes to under other times, without running it: with these parameters over those that it had.

        `limits`, `tape`, `memory_limit`: as for `Machine.run`.
        Raises `UsageError` for a parameter that changes what is done: `Machine.describe()["effect"]` says which change times only.
        """
        ran = _basrelief.retime(self._bytes, settings(given or {}, parameters), (limits, tape), memory_limit)
        return result_of(ran)

    def save(self, path: FilePath) -> None:
        """Writes the tape as a file, as `--tape` does."""
        write(path, self._bytes)

    def __len__(self) -> int:
        """Its size [bytes]."""
        return len(self._bytes)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Tape) and self._bytes == other._bytes

    def __hash__(self) -> int:
        return hash(self._bytes)

    def __repr__(self) -> str:
        return f"Tape({len(self):,} bytes)"


class Result:
    """What a run comes to: its report, its pictures, and its tape."""

    def __init__(self, text: str, image: Picture | None, reference: Picture | None, tape: Tape | None) -> None:
        self._text = text
        self._image = image
        self._reference = reference
        self._tape = tape

    def __getstate__(self) -> tuple[Any, ...]:
        return self._text, self._image, self._reference, self._tape

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        self._text, self._image, self._reference, self._tape = state

    @cached_property
    def report(self) -> dict[str, Any]:
        """The report, as `report.json` has it, but for what the host took."""
        report: dict[str, Any] = json.loads(self._text)
        return report

    def _part(self, name: str, advice: str) -> Any:
        if name not in self.report:
            raise Error(f"the report has no {name}: {advice}")
        return self.report[name]

    def _timed(self, name: str) -> Any:
        return self._part(name, "the functional model has no time, another engine has")

    @property
    def cycles(self) -> int:
        """Cycles of the frames, which the program prints first; `report["cycles"]["total"]` has those behind the last one, too, in which
        what was drawn is shown. Of a run that did not come to its end, all cycles."""
        cycles = self._timed("cycles")
        return sum(cycles["frames"]) if self.report["outcome"]["kind"] == "complete" and cycles["frames"] else int(cycles["total"])

    @property
    def units(self) -> Table:
        """Where the cycles of each unit went, in the order of the block diagram; cycles of waiting are summed over what it waited for,
        `report["units"]` has them one by one."""
        return Table.of_rows([{"unit": name, **_summed(unit)} for name, unit in self._timed("units").items()], _UNITS)

    @property
    def fifos(self) -> Table:
        """How full each FIFO was: slots, tokens, most slots ever held, mean of slots held, and cycles in which it was full."""
        return Table.of_rows([_fifo(name, fifo) for name, fifo in self._timed("fifos").items()])

    @property
    def memories(self) -> Table:
        """What each client of each memory moved, and how it was served."""
        memories = self._timed("memories").items()
        clients = [(name, *client) for name, memory in memories for client in memory["clients"].items()]
        return Table.of_rows([{"memory": memory, "client": name, **_plain(client)} for memory, name, client in clients])

    @property
    def caches(self) -> Table:
        """What the look-ups of each cache found."""
        return Table.of_rows([{"cache": name, **cache} for name, cache in self._timed("caches").items()])

    @property
    def bottlenecks(self) -> Table:
        """Cycles saved when one resource is relaxed, measured by resimulation: resource, relaxation, parameters that set it, cycles of
        the frames with it, and cycles saved."""
        rows = self._part("bottlenecks", "run(limits=True) measures the bottlenecks of any run that completes")
        return Table.of_rows(rows, ["resource", "relaxation", "set", "cycles", "saved"])

    @property
    def limits(self) -> Table:
        """Old name of `bottlenecks`."""
        return self.bottlenecks

    @property
    def figures(self) -> Table:
        """What the machine counted and what follows from it: name, value, unit, and what it is."""
        legend = self.report["legend"]
        counted = [{"figure": name, "value": value, **legend.get(name, {})} for name, value in self.report["figures"].items()]
        derived = [
            {"figure": name, "value": of["value"], "unit": of["unit"], "description": of["formula"]}
            for name, of in self.report["derived"].items()
        ]
        return Table.of_rows(counted + derived, ["figure", "value", "unit", "description"])

    @property
    def image(self) -> Picture:
        """The machine's picture of the last frame."""
        if self._image is None:
            raise Error("there is no picture: a tape that is timed again draws none, nor does a run that ends ahead of its first")
        return self._image

    @property
    def reference(self) -> Picture:
        """The exact picture of the last frame."""
        if self._reference is None:
            raise Error("there is no exact picture: run(exact=True) draws it")
        return self._reference

    @property
    def difference(self) -> Picture:
        """How far the machine's picture is from the exact one, as the program writes it."""
        return Picture(*_basrelief.difference(self.reference._pixels, self.image._pixels))

    @property
    def tape(self) -> Tape:
        """What the units did, without times."""
        if self._tape is None:
            raise Error("no tape was kept: run(tape=True) keeps that of any run that comes to its end")
        return self._tape

    def compare(self, other: Result, names: tuple[str, str] = ("this", "other")) -> Comparison:
        """What changed from this run to another; explained by measuring, where both have tapes."""
        return Comparison(self._side(names[0]), other._side(names[1]))

    def _side(self, name: str) -> _basrelief._Side:
        image, tape = self._image, self._tape
        pixels = None if image is None else image._pixels
        return {"name": name, "report": self._text, "image": pixels, "tape": None if tape is None else tape._bytes}

    def html(self) -> str:
        """The report as one page, as `--html` writes it."""
        return _basrelief.page(self._text, self._shown())

    def _shown(self) -> tuple[_basrelief._Pixels | None, _basrelief._Pixels | None]:
        image, reference = self._image, self._reference
        return None if image is None else image._pixels, None if reference is None else reference._pixels

    def save_html(self, path: FilePath) -> None:
        """Writes the report as one page."""
        write(path, self.html().encode())

    def save(self, folder: FilePath) -> None:
        """Writes pictures, tape and report into a folder, as `--out` does; `basrelief compare` and `load` read them. The report comes
        last: where it is, all is."""
        place = Path(folder)
        place.mkdir(parents=True, exist_ok=True)
        (place / REPORT).unlink(missing_ok=True)
        pictures = [("image", self._image), ("reference", self._reference)]
        for kind, picture in pictures + [("difference", self.difference if self._reference else None)]:
            if picture is not None:
                picture.save(place / f"{kind}.png")
        (place / TAPE).unlink(missing_ok=True)
        if self._tape is not None:
            self._tape.save(place / TAPE)
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
    """The result; raises where the run did not come to its end."""
    tape = ran["tape"]
    result = Result(ran["report"], _picture(ran["image"]), _picture(ran["reference"]), None if tape is None else Tape(tape))
    outcome = result.report["outcome"]
    if outcome["kind"] == "complete":
        return result
    limit = "stopped at the limit of max_cycles; the report holds the state so far"
    raise IncompleteError(limit if outcome["kind"] == "limit" else outcome.get("message", outcome["kind"]), result)


def _picture(pixels: _basrelief._Pixels | None) -> Picture | None:
    return None if pixels is None else Picture(*pixels)


def load(path: FilePath) -> Result:
    """The result of a run that is in a folder, `--out` of the program or `Result.save`: its report, and its tape if it is there. It has no
    pictures."""
    place = Path(path)
    report = place / REPORT if place.is_dir() else place
    text = _basrelief.read_report(str(report), _basrelief.read_text(report))
    tape = report.with_name(TAPE)
    try:
        content = tape.read_bytes() if report.name == REPORT and tape.exists() else None
    except OSError as error:
        raise InputError(f"{tape}: cannot be read: {error.strerror}") from error
    return Result(text, None, None, None if content is None else Tape(content))


_UNITS = ["unit", "numeral", "steps", "tokens", "busy", "starved", "blocked", "memory", "done"]


def _summed(unit: dict[str, Any]) -> dict[str, Any]:
    return {name: sum(value.values()) if isinstance(value, dict) else value for name, value in unit.items()}


def _fifo(name: str, fifo: dict[str, Any]) -> dict[str, Any]:
    histogram = fifo["histogram"]
    held = sum(slots * cycles for slots, cycles in enumerate(histogram))
    figures = {"mean": held / max(sum(histogram), 1), "full": histogram[-1]}
    return {"fifo": name, **_plain(fifo), **figures}


def _plain(part: dict[str, Any]) -> dict[str, Any]:
    """What is a number, not a list."""
    return {name: value for name, value in part.items() if not isinstance(value, list)}
