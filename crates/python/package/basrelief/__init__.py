"""A cycle-level simulator of patented shading devices.

>>> import basrelief
>>> machine = basrelief.Machine("bump", **{"replacement.entries": 64})
>>> result = machine.run(basrelief.demo("golf-ball", size=(64, 48)))
>>> result.cycles == machine.run(basrelief.demo("golf-ball", size=(64, 48)), exact=False).cycles
True

Every figure is the same to the bit as that of the program of the same name.
"""

from ._basrelief import VERSION as __version__
from ._basrelief import DisplayList, Error, InputError, Scene, UsageError
from .comparison import Comparison
from .machine import Machine, machines
from .picture import Picture
from .result import IncompleteError, Result, Tape, load
from .scene import demo, demos, display_list, scene
from .sweep import Sweep, sweep
from .table import Table

__all__ = [
    "Comparison",
    "DisplayList",
    "Error",
    "IncompleteError",
    "InputError",
    "Machine",
    "Picture",
    "Result",
    "Scene",
    "Sweep",
    "Table",
    "Tape",
    "UsageError",
    "__version__",
    "demo",
    "demos",
    "display_list",
    "load",
    "machines",
    "scene",
    "sweep",
]
