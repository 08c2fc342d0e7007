"""Machines."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any, Literal

from . import _basrelief
from ._basrelief import DisplayList, Scene
from .files import FilePath
from .renamed import renamed
from .result import Result, result_of
from .settings import Settings, settings
from .table import Table


def machines() -> dict[str, str]:
    """Returns the machines: name and description."""
    return dict(_basrelief.machines())


class Machine:
    """A machine with its parameters: the defaults, overridden by `config` (a TOML file or a mapping), overridden by single parameters.

    >>> Machine("shade", **{"shade.mode": "normal"})
    Machine('shade', **{'shade.mode': 'normal'})

    Files and values have the form of `--config` and `--set`. Raises `UsageError` for an unknown or invalid parameter, and `InputError`
    for an error in the file.
    """

    __slots__ = ("_config", "_made")

    # Positional only, because a type checker would let any key of `**parameters` match a named argument.
    def __init__(self, name: str, config: FilePath | Mapping[str, Any] | None = None, /, **parameters: Any) -> None:
        if config is None or isinstance(config, Mapping):
            self._make(name, ("", ""), settings(config or {}, parameters))
        else:
            self._make(name, (str(config), _basrelief.read_text(config)), settings({}, parameters))

    def _make(self, name: str, file: tuple[str, str], given: Settings) -> None:
        self._made = (name, file, given)
        self._config = _basrelief.Config(name, file, given)

    @property
    def name(self) -> str:
        """The name, as in `--machine`."""
        return self._made[0]

    def set(self, given: Mapping[str, Any] | None = None, /, **parameters: Any) -> Machine:
        """Returns a copy of this machine with these parameters changed."""
        name, file, before = self._made
        more = settings(given or {}, parameters)
        return _made(name, file, list({**dict(before), **dict(more)}.items()))

    def describe(self) -> Table:
        """Returns all parameters in the order of the block diagram: key, value, default, unit of measure, range, description, effect
        (work or timing), provenance and source."""
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
        `memory_limit`: memory limit of the run [bytes; default 1 GiB].
        `limits`, `tape`: old names of `bottlenecks` and `recording`.

        The run releases Python's global lock; Ctrl-C stops it. Raises `IncompleteError`, which holds the report so far, for a deadlock
        or at `max_cycles`, and `InputError` for a damaged trace.
        """
        options: _basrelief._Options = {
            "engine": engine,
            "max_cycles": max_cycles,
            "exact": exact,
            "bottlenecks": renamed("limits", limits, "bottlenecks", bottlenecks),
            "costs": costs,
            "recording": bool(renamed("tape", tape, "recording", recording)),
            "memory_limit": memory_limit,
        }
        return result_of(_basrelief.run(self._config, scene, options))

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


def _made(name: str, file: tuple[str, str], given: Settings) -> Machine:
    """Makes a machine without reading its file again, which may be gone."""
    machine = Machine.__new__(Machine)
    machine._make(name, file, given)
    return machine


def _provenance(row: dict[str, Any]) -> dict[str, str]:
    return {"provenance": row["provenance"]["kind"], "source": row["provenance"]["text"]}
