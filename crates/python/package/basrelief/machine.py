"""Machines."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any, Literal

from . import _basrelief
from ._basrelief import DisplayList, Scene
from .files import FilePath
from .result import Result, result_of
from .settings import Settings, settings
from .table import Table


def machines() -> dict[str, str]:
    """Names of the machines, each with what it is, in a sentence."""
    return dict(_basrelief.machines())


class Machine:
    """A machine with its parameters: defaults, then those of `config`, a TOML file or a mapping, then single ones.

    >>> Machine("shade", **{"shade.mode": "normal"})
    Machine('shade', **{'shade.mode': 'normal'})

    Files and values are as `--config` and `--set` take them. Raises `UsageError` for what the machine has not, or cannot be, and `InputError` where the file is to blame.
    """

    __slots__ = ("_config", "_made")

    # By place alone: to a type checker, a name beside `**parameters` could be meant by any of their keys.
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
        """As `--machine` names it."""
        return self._made[0]

    def set(self, given: Mapping[str, Any] | None = None, /, **parameters: Any) -> Machine:
        """Another machine, with these parameters over those of this one."""
        name, file, before = self._made
        more = settings(given or {}, parameters)
        return _made(name, file, list({**dict(before), **dict(more)}.items()))

    def describe(self) -> Table:
        """All parameters, in the order of the block diagram: key, value, default, unit, range, what it is, whether it changes work
        or times only, and where the value comes from."""
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
        limits: bool | None = None,
        costs: bool = False,
        tape: bool = False,
        memory_limit: int | None = None,
    ) -> Result:
        """Draws a scene, or replays a display list.

        `exact`: draw the exact picture too, and measure against it.
        `engine`: `timed`; `ticked`, which is slow and says the same; or `functional`, which has no time.
        `max_cycles`: no step starts in this cycle or later.
        `limits`: measure what limits the run; where nothing is said, it is measured if that takes little time beside the pictures.
        `costs`: add up what each polygon and object costs, for `report["costs"]`.
        `tape`: keep the tape however long it is; where limits are measured, that of short work is kept by itself.
        `memory_limit`: for what the run remembers [bytes; default 1 GiB].

        Other threads of Python run meanwhile; Ctrl-C stops it. Raises `IncompleteError`, which holds the report so far, of a run
        that does not come to its end, and `InputError` for a display list that is none.
        """
        options: _basrelief._Options = {
            "engine": engine,
            "max_cycles": max_cycles,
            "exact": exact,
            "limits": limits,
            "costs": costs,
            "tape": tape,
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
    """Without reading the file again, which may not be there any more."""
    machine = Machine.__new__(Machine)
    machine._make(name, file, given)
    return machine


def _provenance(row: dict[str, Any]) -> dict[str, str]:
    return {"provenance": row["provenance"]["kind"], "source": row["provenance"]["text"]}
