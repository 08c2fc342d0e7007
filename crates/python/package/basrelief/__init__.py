"""Cycle-level simulator of four patented shading devices.

>>> import basrelief
>>> machine = basrelief.Machine("bump", **{"replacement.entries": 64})
>>> result = machine.run(basrelief.demo("golf-ball", size=(64, 48)))
>>> result.cycles == machine.run(basrelief.demo("golf-ball", size=(64, 48)), exact=False).cycles
True

All figures equal those of the command line to the bit.
"""

from typing import Any

from ._basrelief import VERSION as __version__
from ._basrelief import DisplayList, Error, InputError, Scene, UsageError
from .comparison import Comparison
from .machine import Machine, machines
from .picture import Picture
from .renamed import warn_renamed
from .result import IncompleteError, Recording, Result, load
from .scene import demo, demos, display_list, scene
from .sizing import FifoSizing, size_fifos
from .sweep import Exploration, Sweep, explore, sweep
from .table import Table

def __getattr__(name: str) -> Any:
    if name == "Tape":
        warn_renamed("basrelief.Tape", "basrelief.Recording")
        return Recording
    raise AttributeError(f"module 'basrelief' has no attribute {name!r}")


__all__ = [
    "Comparison",
    "DisplayList",
    "Error",
    "Exploration",
    "FifoSizing",
    "IncompleteError",
    "InputError",
    "Machine",
    "Picture",
    "Recording",
    "Result",
    "Scene",
    "Sweep",
    "Table",
    "UsageError",
    "__version__",
    "demo",
    "demos",
    "display_list",
    "explore",
    "load",
    "machines",
    "scene",
    "size_fifos",
    "sweep",
]
