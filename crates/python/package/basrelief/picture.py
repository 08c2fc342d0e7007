"""Images."""

from __future__ import annotations

from hashlib import sha256
from typing import Any

from . import _basrelief, arguments
from .files import FilePath, write


class Picture:
    """An image: rows from the top, pixels of red, green, blue and alpha with 8 bits each. Alpha is 255 for covered pixels.

    `numpy.asarray(picture)` gives an array of height x width x 4 without a copy. `PIL.Image.fromarray(picture)` works too.
    """

    __slots__ = ("_pixels",)

    def __init__(self, width: int, height: int, rgba: bytes) -> None:
        self._pixels = (width, height, rgba)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height [pixels]."""
        return self._pixels[:2]

    def tobytes(self) -> bytes:
        """Returns the pixels."""
        return self._pixels[2]

    @property
    def __array_interface__(self) -> dict[str, Any]:
        width, height, rgba = self._pixels
        # Without strides Pillow asks for a buffer, although they follow from the shape.
        return {"shape": (height, width, 4), "strides": (4 * width, 4, 1), "typestr": "|u1", "data": rgba, "version": 3}

    def png(self) -> bytes:
        """Returns the image as a PNG file."""
        return _basrelief.png(self._pixels)

    def save(self, path: FilePath) -> None:
        """Writes the image as a PNG file, with the same bytes as the command line. Raises `UsageError` for the name of another format."""
        write(arguments.path_of_format("path", path, ".png"), self.png())

    def _sha256(self) -> str:
        """Returns the hash of the colours, as in a report."""
        _, _, rgba = self._pixels
        rgb = bytearray(len(rgba) // 4 * 3)
        for channel in range(3):
            rgb[channel::3] = rgba[channel::4]
        return sha256(rgb).hexdigest()

    def _repr_png_(self) -> bytes:
        return self.png()

    def __repr__(self) -> str:
        width, height = self.size
        return f"Picture({width} x {height})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Picture) and self._pixels == other._pixels

    def __hash__(self) -> int:
        return hash(self._pixels)
