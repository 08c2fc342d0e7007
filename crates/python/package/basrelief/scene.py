"""What is drawn."""

from __future__ import annotations

from . import _basrelief
from ._basrelief import DisplayList, Scene
from .files import FilePath
from .table import Table


def demos() -> Table:
    """The demo scenes: name, the machine that each is made for, and what it shows."""
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
    """A demo scene; some have a tessellation, as in `goblet@8`. How it is looked at is said as for `scene`."""
    return Scene.demo(name, _view(size, camera, turn, zoom, frames, orbit, light, light_orbit), memory_limit)


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
    """A model: a .glb, .gltf or .obj file.

    `size`: of the picture [pixels; default 640 x 480].
    `camera`: a file with view_projection, to_light and to_viewer.
    `turn`: of the camera about the model: around the vertical axis, then upwards [degrees].
    `zoom`: see all so much larger.
    `frames`: number of pictures.
    `orbit`, `light_orbit`: turn the camera, the light, about the model by this much over all frames [degrees].
    `light`: direction to the light, in world space, instead of the scene's lights.
    `memory_limit`: for what is held of the scene [bytes; default 1 GiB].
    `allow_outside`: the model may name files outside its folder, with `../`.

    A scene pickles as the bytes of its files and its view. Raises `InputError` for a file that cannot be drawn.
    """
    view = _view(size, camera, turn, zoom, frames, orbit, light, light_orbit)
    return Scene.open(path, view, memory_limit, allow_outside)


def display_list(path: FilePath) -> DisplayList:
    """A display list, which carries its own view. It is read anew for each run, and pickles as its path."""
    return DisplayList(path)


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
    return {
        "size": size,
        "camera": None if camera is None else (str(camera), _basrelief.read_text(camera)),
        "turn": turn,
        "zoom": zoom,
        "frames": frames,
        "orbit": orbit,
        "light": light,
        "light_orbit": light_orbit,
    }
