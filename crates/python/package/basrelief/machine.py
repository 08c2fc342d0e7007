"""Machines."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any, Literal

from . import _basrelief, arguments
from ._basrelief import DisplayList, Scene
from .files import FilePath, optional_path
from .renamed import renamed
from .result import Result, result_of
from .settings import Settings, settings
from .table import Table


def machines() -> dict[str, str]:
    """Returns the machines: name and description."""
    return dict(_basrelief.machines())


class Machine:
    """A machine with its parameters: the defaults, overridden by `config` (a file or a mapping), overridden by single parameters.

    >>> Machine("shade", **{"shade.mode": "normal"})
    Machine('shade', **{'shade.mode': 'normal'})

    Files and values have the form of `--config` and `--set`: a file is TOML, JSON, or a report.json, whose `config` is used. Raises
    `UsageError` for an unknown or invalid parameter, and `InputError` for an error in the file.
    """

    __slots__ = ("_config", "_made")

    # Positional only, because a type checker would let any key of `**parameters` match a named argument.
    def __init__(self, name: str, config: FilePath | Mapping[str, Any] | None = None, /, **parameters: Any) -> None:
        if config is None or isinstance(config, Mapping):
            self._make(name, ("", ""), settings(config, parameters))
        else:
            file = arguments.path("config", config)
            self._make(name, (file, _basrelief.read_text(file)), settings({}, parameters))

    def _make(self, name: str, file: tuple[str, str], given: Settings) -> None:
        arguments.word("name", name)
        self._made = (name, file, given)
        self._config = _basrelief.Config(name, file, given)

    @property
    def name(self) -> str:
        """The name, as in `--machine`."""
        return self._made[0]

    def set(self, given: Mapping[str, Any] | None = None, /, **parameters: Any) -> Machine:
        """Returns a copy of this machine with these parameters changed."""
        name, file, before = self._made
        more = settings(given, parameters)
        return _made(name, file, list({**dict(before), **dict(more)}.items()))

    def describe(self) -> Table:
        """Returns all parameters in the order of the block diagram: key, value, default, unit of measure, range, description, effect
        (work, timing or cost), provenance and source."""
        rows = json.loads(self._config.described())
        kept = ("key", "value", "default", "unit", "range", "about", "effect")
        return Table.of_rows([{**{name: row[name] for name in kept}, **_provenance(row)} for row in rows])

    def run(
        self,
        scene: Scene | DisplayList,
        *,
        exact: bool = True,
        engine: Literal["timed", "ticked", "functional"] = "timed",
        max_cycles: int | None = None,
        bottlenecks: bool | None = None,
        costs: bool = False,
        recording: bool = False,
        sensitivity: bool = False,
        timeline: FilePath | None = None,
        waves: FilePath | None = None,
        tokens: FilePath | None = None,
        tokens_every: int = 64,
        tokens_of: Literal["fragments", "polygons"] = "fragments",
        from_cycle: int | None = None,
        to_cycle: int | None = None,
        units: Sequence[str] = (),
        requests: FilePath | None = None,
        requests_format: Literal["csv", "dramsim3", "ramulator", "ramulator2"] = "csv",
        requests_memory: str | None = None,
        memory_limit: int | None = None,
        limits: bool | None = None,
        tape: bool | None = None,
    ) -> Result:
        """Draws a scene or replays a trace.

        `exact`: compute the reference image and the quality figures.
        `engine`: `timed`; `ticked`, which is slow and gives the same report; or `functional`, without timing.
        `max_cycles`: stop before this cycle.
        `bottlenecks`: analyse bottlenecks; by default only if the recording is short.
        `costs`: attribute the unit cycles to polygons and objects, in `report["costs"]`.
        `recording`: keep the recording even if it is long; a short one is kept if bottlenecks are analysed.
        `sensitivity`: repeat the run with each assumed parameter changed, about 300 runs; the result is `Result.sensitivity`.
        `timeline`: file for a timeline of all units, a Perfetto trace.
        `waves`: file for waveforms of all units and FIFOs, as FST.
        `tokens`: file for the paths of single tokens, for Konata; compressed if its name ends in `.zst`.
        `tokens_every`, `tokens_of`: one token out of so many, and their kind.
        `from_cycle`, `to_cycle`, `units`: the part that timeline, waves and tokens show.
        `requests`: file for all memory requests.
        `requests_format`, `requests_memory`: file format, and the only memory to write.
        `memory_limit`: memory limit of the run [bytes; default 1 GiB].
        `limits`, `tape`: old names of `bottlenecks` and `recording`.

        The run releases Python's global lock; Ctrl-C stops it. Raises `IncompleteError`, which holds the report so far, for a deadlock
        or at `max_cycles`, and `InputError` for a damaged trace.
        """
        limited = renamed("limits", limits, "bottlenecks", bottlenecks)
        options = _options(engine=engine, max_cycles=max_cycles, exact=exact, memory_limit=memory_limit)
        options["bottlenecks"] = None if limited is None else arguments.truth("bottlenecks", limited)
        options["costs"] = arguments.truth("costs", costs)
        options["recording"] = arguments.truth("recording", renamed("tape", tape, "recording", recording))
        options["sensitivity"] = arguments.truth("sensitivity", sensitivity)
        options["outputs"] = {
            "timeline": optional_path("timeline", timeline),
            "waves": None if waves is None else arguments.path_of_format("waves", waves, ".fst"),
            "tokens": optional_path("tokens", tokens),
            "tokens_every": arguments.whole("tokens_every", tokens_every, least=1),
            "tokens_of": arguments.word("tokens_of", tokens_of),
            "from_cycle": None if from_cycle is None else arguments.whole("from_cycle", from_cycle),
            "to_cycle": None if to_cycle is None else arguments.whole("to_cycle", to_cycle, least=1),
            "units": arguments.words("units", units),
            "requests": optional_path("requests", requests),
            "requests_format": arguments.word("requests_format", requests_format),
            "requests_memory": None if requests_memory is None else arguments.word("requests_memory", requests_memory),
        }
        return result_of(_basrelief.run(self._config, arguments.drawn(scene), options))

    def ablate(
        self, scene: Scene | DisplayList, *, max_cycles: int | None = None, memory_limit: int | None = None
    ) -> Table:
        """Runs the scene as configured, with each shortcut of the machine switched off in turn, and with all off, as `--ablate` does.
        Returns a row for each run. Raises `UsageError` for a machine without shortcuts."""
        options = _options(exact=False, max_cycles=max_cycles, memory_limit=memory_limit)
        ablation = json.loads(_basrelief.ablate(self._config, arguments.drawn(scene), options))
        return Table.of_rows(ablation["variants"])

    def compare_methods(
        self,
        scene: Scene | DisplayList,
        *,
        exact: bool = True,
        max_cycles: int | None = None,
        memory_limit: int | None = None,
    ) -> Table:
        """Runs the scene with each division method of the machine at the same error, as `--compare-methods` does. Returns a row for each
        method. Raises `UsageError` for a machine without methods."""
        options = _options(exact=exact, max_cycles=max_cycles, memory_limit=memory_limit)
        compared = json.loads(_basrelief.compare_methods(self._config, arguments.drawn(scene), options))
        return Table.of_rows(compared["methods"])

    def record(self, scene: Scene, path: FilePath, *, expect: bool = False, memory_limit: int | None = None) -> int:
        """Writes a scene as a trace (display list), as `basrelief record` does. Returns the number of its commands.

        `path`: `.jsonl` or `.bdl`, or either with `.zst` appended.
        `expect`: the trace also states the results of its replay, which `basrelief verify` checks.
        """
        limit = None if memory_limit is None else arguments.whole("memory_limit", memory_limit)
        file = arguments.path("path", path)
        return _basrelief.record(self._config, arguments.drawn(scene), file, arguments.truth("expect", expect), limit)

    def __reduce__(self) -> tuple[Any, ...]:
        return _made, self._made

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Machine) and self._made == other._made

    def __hash__(self) -> int:
        name, file, given = self._made
        return hash((name, file, tuple(given)))

    def __repr__(self) -> str:
        name, (file, _), given = self._made
        config = f", {file!r}" if file else ""
        return f"Machine({name!r}{config}{f', **{dict(given)!r}' if given else ''})"

    def _repr_html_(self) -> str:
        return self.describe()._repr_html_()


def _options(
    *, engine: str = "timed", exact: bool, max_cycles: int | None, memory_limit: int | None
) -> _basrelief._Options:
    """Returns the options of a run without analyses and further files."""
    return {
        "engine": arguments.word("engine", engine),
        "max_cycles": None if max_cycles is None else arguments.whole("max_cycles", max_cycles),
        "exact": arguments.truth("exact", exact),
        "bottlenecks": False,
        "costs": False,
        "recording": False,
        "sensitivity": False,
        "memory_limit": None if memory_limit is None else arguments.whole("memory_limit", memory_limit),
        "outputs": {
            "timeline": None,
            "waves": None,
            "tokens": None,
            "tokens_every": 64,
            "tokens_of": "fragments",
            "from_cycle": None,
            "to_cycle": None,
            "units": [],
            "requests": None,
            "requests_format": "csv",
            "requests_memory": None,
        },
    }


def _made(name: str, file: tuple[str, str], given: Settings) -> Machine:
    """Makes a machine without reading its file again, which may be gone."""
    machine = Machine.__new__(Machine)
    machine._make(name, file, given)
    return machine


def _provenance(row: dict[str, Any]) -> dict[str, str]:
    return {"provenance": row["provenance"]["kind"], "source": row["provenance"]["text"]}
