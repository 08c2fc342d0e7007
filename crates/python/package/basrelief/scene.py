"""Inputs of a run: scenes and traces."""

from __future__ import annotations

from . import _basrelief, arguments
from ._basrelief import DisplayList, Scene
from .files import FilePath
from .table import Table


def demos() -> Table:
    """Returns the demo scenes: name, machine and description."""
    return Table.of_rows([{"name": name, "machine": machine, "about": about} for name, machine, about in _basrelief.demos()])


def demo(
    name: str,
    *,
    size: tuple[int, int] | None = None,
    camera: FilePath | None = None,
    turn: tuple[float, float] | None = None,
    zoom: float | None = None,
    frames: int | None = None,
    orbit: float | None = None,
    light: tuple[float, float, float] | None = None,
    light_orbit: float | None = None,
    memory_limit: int | None = None,
) -> Scene:
    """Returns a demo scene. Some have a tessellation, for example `goblet@8`. The other arguments are those of `scene`."""
    view = _view(size, camera, turn, zoom, frames, orbit, light, light_orbit)
    return Scene.demo(arguments.word("name", name), view, _limit(memory_limit))


def scene(
    path: FilePath,
    *,
    size: tuple[int, int] | None = None,
    camera: FilePath | None = None,
    turn: tuple[float, float] | None = None,
    zoom: float | None = None,
    frames: int | None = None,
    orbit: float | None = None,
    light: tuple[float, float, float] | None = None,
    light_orbit: float | None = None,
    memory_limit: int | None = None,
    allow_outside: bool = False,
) -> Scene:
    """Opens a model: a .glb, .gltf or .obj file.

    `size`: image size [pixels; default 640 x 480].
    `camera`: camera file (JSON) with view_projection, to_light and to_viewer.
    `turn`: rotation of the camera about the model: around the vertical axis, then upwards [degrees].
    `zoom`: zoom factor about the image centre.
    `frames`: number of frames.
    `orbit`, `light_orbit`: rotation of the camera or the light about the model over all frames [degrees]. Frame k of n, from 0, has
    turned by k / n of it, so one frame alone does not turn.
    `light`: direction to the light in world space; replaces the lights of the scene.
    `memory_limit`: memory limit of the scene [bytes; default 1 GiB].
    `allow_outside`: the model may name files outside its folder, with `../`.

    A pickled scene contains the bytes of its files and its view. Raises `InputError` for a file that cannot be read.
    """
    view = _view(size, camera, turn, zoom, frames, orbit, light, light_orbit)
    return Scene.open(arguments.path("path", path), view, _limit(memory_limit), arguments.truth("allow_outside", allow_outside))


def display_list(path: FilePath) -> DisplayList:
    """Opens a trace (display list), which has its own view. Each run reads it again. A pickled trace contains only its path."""
    return DisplayList(arguments.path("path", path))


def _view(
    size: tuple[int, int] | None,
    camera: FilePath | None,
    turn: tuple[float, float] | None,
    zoom: float | None,
    frames: int | None,
    orbit: float | None,
    light: tuple[float, float, float] | None,
    light_orbit: float | None,
) -> _basrelief._View:
    file = None if camera is None else arguments.path("camera", camera)
    return {
        "size": None if size is None else arguments.size("size", size),
        "camera": None if file is None else (file, _basrelief.read_text(file)),
        "turn": None if turn is None else arguments.numbers("turn", turn, 2),
        "zoom": None if zoom is None else arguments.number("zoom", zoom),
        "frames": None if frames is None else arguments.whole("frames", frames, least=1),
        "orbit": None if orbit is None else arguments.number("orbit", orbit),
        "light": None if light is None else arguments.numbers("light", light, 3),
        "light_orbit": None if light_orbit is None else arguments.number("light_orbit", light_orbit),
    }


def _limit(memory_limit: int | None) -> int | None:
    return None if memory_limit is None else arguments.whole("memory_limit", memory_limit)
