"""Pictures."""

from __future__ import annotations

from typing import Any

from . import _basrelief
from .files import FilePath, write


class Picture:
    """A picture: rows from the top, pixels of red, green, blue and alpha, 8 bits each. Alpha is 255 where something was drawn.

    `numpy.asarray(picture)` is an array of height x width x 4 in the memory of the picture; `PIL.Image.fromarray(picture)`
    takes it, too.
    """

    __slots__ = ("_pixels",)

    def __init__(self, width: int, height: int, rgba: bytes) -> None:
        self._pixels = (width, height, rgba)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height [pixels]."""
        return self._pixels[:2]

    def tobytes(self) -> bytes:
        """The pixels."""
        return self._pixels[2]

    @property
    def __array_interface__(self) -> dict[str, Any]:
        width, height, rgba = self._pixels
        # Strides, though they follow from the shape: where there are none, Pillow asks for a buffer.
        return {"shape": (height, width, 4), "strides": (4 * width, 4, 1), "typestr": "|u1", "data": rgba, "version": 3}

    def png(self) -> bytes:
        """The picture as a PNG file."""
        return _basrelief.png(self._pixels)

    def save(self, path: FilePath) -> None:
        """Writes the picture as a PNG file: the bytes that the program writes."""
        write(path, self.png())

    def _repr_png_(self) -> bytes:
        return self.png()

    def __repr__(self) -> str:
        width, height = self.size
        return f"Picture({width} x {height})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Picture) and self._pixels == other._pixels

    def __hash__(self) -> int:
        return hash(self._pixels)
