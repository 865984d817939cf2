"""Pictures of worlds and recordings."""
from __future__ import annotations

import ctypes
import os
import threading
import weakref
from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np

from . import _abi
from ._bodies import Vector
from ._library import Handle, check, encode, invalid, lib

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._options import PainterOptions

_VIEW = ("eye", "target", "field_of_view")


class Painter:
    """Draws the pictures of one world or recording with OpenGL, without a display.

    Colors are chosen from the first picture. A painter is used by the thread that made it.

    Args:
        width, height: Size [pixels].
        samples: Per pixel; None: 16 on a GPU, 4 in software.
        color_by: "body", "speed", "strain" or another quantity of ``rubble render --color-by``.
        full_value: Value of the hottest color; 0: the largest one of each picture.
    Raises:
        Error: If the build or the machine has no OpenGL.
    """

    _kept = threading.local()  # of a thread: owner, options and painter of the last picture

    def __init__(self, width: int = 1280, height: int = 720, samples: Optional[int] = None,
                 color_by: str = "body", full_value: float = 0) -> None:
        options: dict[str, Any] = {"width": width, "height": height, "color_by": color_by,
                                   "full_value": full_value}
        if samples is not None:
            options["samples"] = samples
        self._handle = Handle(lib.rb_painter_create, lib.rb_painter_destroy, encode(options))

    @classmethod
    def shared(cls, owner: Any, options: dict[str, Any]) -> "Painter":
        """The painter that an owner used last, if it has the same options. A thread has one at a time, since
        painters share the OpenGL context that is current."""
        wanted = {key: value for key, value in options.items() if key not in _VIEW}
        found = getattr(cls._kept, "last", None)
        if found is not None and found[0]() is owner and found[1] == wanted:
            return found[2]
        if found is not None:
            cls._kept.last = None
            found[2]._handle.close()
        painter = cls(**wanted)
        cls._kept.last = (weakref.ref(owner), wanted, painter)
        return painter

    def draw(self, world: Any, eye: Optional[Vector] = None, target: Optional[Vector] = None,
             field_of_view: float = 0.6) -> np.ndarray:
        """A picture of a world as it is now; see `World.render`."""
        image = _abi.Image()
        view = _camera(eye, target, field_of_view)
        check(lib.rb_painter_draw_world(self._handle.pointer, world._pointer, view, ctypes.byref(image)))
        return _pixels(image)

    def draw_frame(self, recording: Any, index: int, options: dict[str, Any]) -> np.ndarray:
        """A picture of a frame of a recording; see `Recording.render`."""
        image = _abi.Image()
        view = _camera(**{"eye": None, "target": None, "field_of_view": 0.6,
                          **{key: value for key, value in options.items() if key in _VIEW}})
        check(lib.rb_painter_draw_frame(self._handle.pointer, recording._pointer, index, view,
                                        ctypes.byref(image)))
        return _pixels(image)


def _camera(eye: Optional[Vector], target: Optional[Vector], field_of_view: float) -> Any:
    if (eye is None) != (target is None):
        raise invalid("camera", "both eye and target, or neither", "one of them")
    if eye is None or target is None:
        return None
    return ctypes.byref(_abi.Camera(tuple(eye), tuple(target), field_of_view))


def _pixels(image: _abi.Image) -> np.ndarray:
    raw = ctypes.string_at(image.rgb, 3 * image.width * image.height)
    return np.frombuffer(raw, np.uint8).reshape(image.height, image.width, 3)


class View:
    """Pictures of a world."""

    def render(self, width: int = 1280, height: int = 720, *, eye: Optional[Vector] = None,
               target: Optional[Vector] = None, field_of_view: float = 0.6,
               **options: Unpack[PainterOptions]) -> np.ndarray:
        """A picture of the world as it is now.

        Args:
            width, height: Size [pixels].
            eye, target: Of the camera [m]; None: one that shows everything.
            field_of_view: Full vertical angle [rad].
            options: samples, color_by and full_value, as for `Painter`.
        Returns:
            (height, width, 3) bytes: red, green, blue, sRGB; rows from the top.
        Raises:
            Error: If the build or the machine has no OpenGL.
        """
        painter = Painter.shared(self, {"width": width, "height": height, **options})
        return painter.draw(self, eye, target, field_of_view)


def save_png(picture: np.ndarray, file: Union[str, os.PathLike[str]]) -> None:
    """Writes a picture (height, width, 3) of bytes to a PNG file."""
    pixels = np.ascontiguousarray(picture, np.uint8)
    if pixels.ndim != 3 or pixels.shape[2] != 3:
        raise invalid("picture", "shape (height, width, 3)", f"shape {pixels.shape}")
    check(lib.rb_write_png(os.fsencode(file), pixels.ctypes.data, pixels.shape[1], pixels.shape[0]))
