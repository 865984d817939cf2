"""Trajectory files."""
from __future__ import annotations

import ctypes
import os
from typing import TYPE_CHECKING, Any, Iterator, NamedTuple, Optional, Union

import numpy as np

from . import _abi
from ._film import NOTEBOOK, Film, checked, film_of, in_notebook
from ._library import Handle, check, json_of, lib, structs
from ._progress import ProgressOption
from ._world import World

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._options import PictureOptions

Path = Union[str, os.PathLike[str]]


class Recorder:
    """Writes a trajectory: ``with rubble.Recorder(world, "out.rubble") as out: out.write()`` after each step.

    Args:
        world: Whose frames are written.
        file: Name of the file, which ends in ".rubble"; `rubble view` and `Recording` read it.
        title: Shown by the viewer.
        resolution: Positions are rounded to multiples of it [m]; 0: one that no picture shows.
    """

    def __init__(self, world: World, file: Path, title: str = "", resolution: float = 0) -> None:
        self._world = world
        self._handle = Handle(lib.rb_recorder_create, lib.rb_recorder_destroy, world._pointer,
                              os.fsencode(file), title.encode(), resolution)

    def write(self) -> None:
        """Adds the present state as a frame."""
        check(lib.rb_recorder_write(self._handle.pointer, self._world._pointer))

    def close(self) -> None:
        """Writes the last frames and the index."""
        if self._handle.pointer:
            check(lib.rb_recorder_finish(self._handle.pointer))
            self._handle.close()

    def __enter__(self) -> "Recorder":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()


class Frame(NamedTuple):
    """A frame of a recording."""

    step: int  #: steps taken before it
    time: float  #: [s]
    positions: np.ndarray  #: (n, 3) of the bodies [m]
    orientations: np.ndarray  #: (n, 4) body -> world, scalar first
    vertices: np.ndarray  #: (m, 3) of all deformable objects, one after the other [m]


class Recording:
    """Reads a trajectory: ``len(recording)``, ``recording[0]``, iteration over frames.

    Attributes:
        title: Of the run.
        dt: Time between two steps [s].
        gravity: (3,) [m/s2].
        resolution: Positions are multiples of it [m].
        complete: Whether the writer came to its end. If not, the frames are those that were written by then.
        file_bytes, intact_bytes: Sizes of the file, and of its part up to the end of the last whole chunk
            of frames [bytes].
    """

    def __init__(self, file: Path) -> None:
        self._file = os.fspath(file)
        self._handle = Handle(lib.rb_recording_open, lib.rb_recording_close, os.fsencode(file))
        info = json_of(lib.rb_recording_info, self._pointer)
        self.title: str = info["title"]
        self.dt: float = info["dt"]
        self.gravity = np.array(info["gravity"])
        self.resolution: float = info["resolution"]
        self.complete: bool = info["complete"]
        self.file_bytes: int = info["file_bytes"]
        self.intact_bytes: int = info["intact_bytes"]
        self._count: int = info["frames"]

    @property
    def _pointer(self) -> ctypes.c_void_p:
        return self._handle.pointer

    def __len__(self) -> int:
        return self._count

    def _index(self, index: int) -> int:
        at = index + self._count if index < 0 else index
        if not 0 <= at < self._count:
            raise IndexError(f"frame {index} of {self._count}")
        return at

    def __getitem__(self, index: int) -> Frame:
        frame = _abi.Frame()
        check(lib.rb_recording_frame(self._pointer, self._index(index), ctypes.byref(frame)))
        poses = structs(frame.poses, frame.pose_count, _abi.Pose)
        vertices = structs(frame.vertices, 3 * frame.vertex_count, ctypes.c_double)
        return Frame(frame.step, frame.time, poses["position"], poses["orientation"], vertices.reshape(-1, 3))

    def __iter__(self) -> Iterator[Frame]:
        return (self[index] for index in range(self._count))

    def objects(self, index: int = 0) -> dict[str, Any]:
        """"bodies" and "deformables" of a frame, in the order of its poses and vertices."""
        return json_of(lib.rb_recording_objects, self._pointer, self._index(index))

    def render(self, index: int, **options: Unpack[PictureOptions]) -> np.ndarray:
        """A picture of a frame; options as for `World.render`."""
        from ._picture import Painter
        given: dict[str, Any] = {**options}
        return Painter.shared(self, given).draw_frame(self, self._index(index), given)

    def film(self, file: Optional[Path] = None, *, fps: float = 30, slow: float = 1,
             progress: ProgressOption = None, **options: Unpack[PictureOptions]) -> Film:
        """A film of the recording, which a notebook shows; arguments, options and errors are those of
        `World.film`. A picture shows the frame that is next in time."""
        suffix = checked(file, fps, slow, {**options})
        times = np.array([frame.time for frame in self])
        wanted = np.arange(times[0], times[-1] + 1e-9, 1 / (fps * slow)) if len(times) else times
        indices = np.minimum(np.searchsorted(times, wanted - 1e-9), len(times) - 1).tolist()
        return film_of(self, indices, file, suffix, fps, progress, {**options})

    def _repr_png_(self) -> Optional[bytes]:
        return in_notebook(lambda: self.render(-1, **NOTEBOOK)) if self._count else None

    def __repr__(self) -> str:
        torn = "" if self.complete else f", cut off at {self.intact_bytes} of {self.file_bytes} bytes"
        return f"<rubble.Recording {self._file!r}, {self._count} frames{torn}>"
