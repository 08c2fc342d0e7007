"""Interface of the extension module: strings, bytes and numbers."""

from os import PathLike
from typing import TypedDict, final

__all__ = [
    "VERSION",
    "Config",
    "DisplayList",
    "Error",
    "InputError",
    "Plan",
    "Scene",
    "UsageError",
    "ablate",
    "compare",
    "compare_methods",
    "compared",
    "demos",
    "difference",
    "explore",
    "figure",
    "machines",
    "page",
    "part",
    "png",
    "read_png",
    "read_report",
    "read_text",
    "record",
    "resimulate",
    "run",
    "size_fifos",
    "text",
    "work_alone",
    "write",
]

VERSION: str

_Path = str | PathLike[str]
# Width, height, and RGBA bytes, top row first.
_Pixels = tuple[int, int, bytes]
_Settings = list[tuple[str, str]]

class _View(TypedDict):
    size: tuple[int, int] | None
    camera: tuple[str, str] | None
    turn: tuple[float, ...] | None
    zoom: float | None
    frames: int | None
    orbit: float | None
    light: tuple[float, ...] | None
    light_orbit: float | None

class _Outputs(TypedDict):
    timeline: _Path | None
    waves: _Path | None
    tokens: _Path | None
    tokens_every: int
    tokens_of: str
    from_cycle: int | None
    to_cycle: int | None
    units: list[str]
    requests: _Path | None
    requests_format: str
    requests_memory: str | None

class _Options(TypedDict):
    engine: str
    max_cycles: int | None
    exact: bool
    bottlenecks: bool | None
    costs: bool
    recording: bool
    sensitivity: bool
    memory_limit: int | None
    outputs: _Outputs

class _Ran(TypedDict):
    report: str
    image: _Pixels | None
    reference: _Pixels | None
    recording: bytes | None

class _Side(TypedDict):
    name: str
    report: str
    image: _Pixels | None
    recording: bytes | None

class Error(Exception):
    """Base class of all errors."""

class UsageError(Error):
    """Wrong arguments; exit code 2 of the command line."""

class InputError(Error):
    """Bad input; exit code 1 of the command line."""

@final
class Config:
    """A machine with valid parameters."""

    def __new__(cls, machine: str, file: tuple[str, str], settings: _Settings) -> Config: ...
    def described(self) -> str: ...

@final
class Scene:
    """A scene. Work that does not depend on parameters is done once for all runs."""

    @property
    def name(self) -> str:
        """The name that the user gave."""
    @property
    def frames(self) -> int:
        """Number of frames."""
    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the images [pixels]."""
    @property
    def triangles(self) -> int:
        """Number of triangles of the model."""
    @property
    def warnings(self) -> list[str]:
        """Warnings of the import, one sentence each."""
    @staticmethod
    def demo(name: str, view: _View, memory_limit: int | None) -> Scene: ...
    @staticmethod
    def open(path: _Path, view: _View, memory_limit: int | None, allow_outside: bool) -> Scene: ...
    @staticmethod
    def of_files(main: tuple[str, bytes], files: dict[str, bytes], view: _View, memory_limit: int | None) -> Scene: ...

@final
class DisplayList:
    """A trace (display list). Each run reads it again. A pickled trace contains only its path."""

    def __new__(cls, path: _Path) -> DisplayList: ...
    @property
    def name(self) -> str:
        """The name that the user gave."""

@final
class Plan:
    """A valid plan with its inputs open."""

    def __new__(cls, name: _Path, text: str, memory_limit: int | None) -> Plan: ...
    def __len__(self) -> int: ...
    @property
    def title(self) -> str:
        """The title of the plan."""
    @property
    def warnings(self) -> list[str]:
        """Warnings about figures that the plan names."""
    def missing(self, folder: _Path, retry_failed: bool) -> list[tuple[str, str]]: ...
    def execute(
        self, points: list[str], folder: _Path, at_once: int | None, options: tuple[bool, bool]
    ) -> tuple[int, int, int, int]: ...
    def tables(self, folder: _Path) -> str: ...

def explore(
    plan: tuple[_Path, str, int | None],
    limit: tuple[int | None, float | None, int],
    folder: _Path,
    at_once: int | None,
    options: tuple[bool, bool],
) -> tuple[tuple[int, int, int, int, int, int], str, float | None, list[str]]: ...
def work_alone() -> None: ...
def machines() -> list[tuple[str, str]]: ...
def demos() -> list[tuple[str, str, str]]: ...
def read_text(path: _Path) -> str: ...
def run(config: Config, drawn: Scene | DisplayList, options: _Options) -> _Ran: ...
def ablate(config: Config, drawn: Scene | DisplayList, options: _Options) -> str: ...
def compare_methods(config: Config, drawn: Scene | DisplayList, options: _Options) -> str: ...
def record(config: Config, drawn: Scene | DisplayList, path: _Path, expect: bool, memory_limit: int | None) -> int: ...
def size_fifos(recordings: list[bytes], within: list[float], memory_limit: int | None) -> str: ...
def figure(report: str, name: str) -> int | float: ...
def resimulate(recording: bytes, settings: _Settings, keep: tuple[bool | None, bool], memory_limit: int | None) -> _Ran: ...
def compare(a: _Side, b: _Side) -> tuple[str, str]: ...
def compared(a: _Side, b: _Side) -> str: ...
def page(report: str, pictures: tuple[_Pixels | None, _Pixels | None]) -> str: ...
def part(report: str, pictures: tuple[_Pixels | None, _Pixels | None]) -> str: ...
def read_report(name: str, text: str) -> str: ...
def text(report: str) -> str: ...
def write(path: _Path, content: bytes) -> None: ...
def png(pixels: _Pixels) -> bytes: ...
def read_png(path: str | PathLike[str]) -> _Pixels: ...
def difference(exact: _Pixels, machine: _Pixels) -> _Pixels: ...
