"""Films of worlds and recordings, and pictures for notebooks."""
from __future__ import annotations

import base64
import os
import pathlib
import shutil
import struct
import subprocess
import tempfile
import zlib
from typing import TYPE_CHECKING, Any, Callable, Iterator, Optional, Sequence, Union

import numpy as np

from ._library import Error, invalid
from ._progress import Progress, ProgressOption

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._options import PictureOptions

Path = Union[str, os.PathLike[str]]
_TYPES = {".mp4": "video/mp4", ".webm": "video/webm", ".gif": "image/gif", ".png": "image/png"}
_CODECS = {".mp4": ["-c:v", "libx264", "-crf", "17", "-pix_fmt", "yuv420p", "-movflags", "+faststart"],
           ".webm": ["-c:v", "libvpx-vp9", "-crf", "30", "-b:v", "0", "-pix_fmt", "yuv420p"],
           ".gif": ["-filter_complex", "[0:v]split[a][b];[a]palettegen=stats_mode=diff[p];[b][p]paletteuse"]}
NOTEBOOK: dict[str, Any] = {"width": 640, "height": 360}  #: size of pictures in a notebook [pixels]


class Film:
    """A film, which a notebook shows. `World.film` and `Recording.film` make it.

    Attributes:
        data: Content of the file.
        type: "video/mp4", "video/webm", "image/gif", or "image/png" for an animated PNG.
        width, height: Size [pixels].
        fps: Pictures per second of film [1/s].
        frames: Number of pictures.
    """

    def __init__(self, data: bytes, suffix: str, width: int, height: int, fps: float, frames: int) -> None:
        self.data, self.type = data, _TYPES[suffix]
        self.width, self.height, self.fps, self.frames = width, height, fps, frames
        self._suffix = suffix

    def save(self, file: Path) -> None:
        """Writes the film to a file. Raises `Error` unless its name ends as that of this type does."""
        suffix = pathlib.Path(file).suffix.lower()
        if suffix != self._suffix:
            raise invalid("file", f"a name that ends in {self._suffix}", repr(os.fspath(file)))
        pathlib.Path(file).write_bytes(self.data)

    def _repr_html_(self) -> str:
        source = f"data:{self.type};base64,{base64.b64encode(self.data).decode()}"
        size = f'width="{self.width}" height="{self.height}"'
        if self.type.startswith("image/"):
            return f'<img {size} src="{source}" alt="film of {self.frames} pictures">'
        return f'<video {size} src="{source}" controls autoplay loop muted playsinline></video>'

    def __repr__(self) -> str:
        seconds = self.frames / self.fps
        return f"<rubble.Film {self.width}x{self.height}, {seconds:.3g} s, {len(self.data)} bytes>"


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png_of(pictures: Sequence[np.ndarray], fps: float = 0) -> bytes:
    """Pictures (height, width, 3) as a PNG, an animated one if there are several."""
    height, width, _ = pictures[0].shape
    animated = len(pictures) > 1
    out = b"\x89PNG\r\n\x1a\n" + _chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
    if animated:
        out += _chunk(b"acTL", struct.pack(">II", len(pictures), 0))
    number = 0
    parts = [out]
    for k, picture in enumerate(pictures):
        if animated:
            parts.append(_chunk(b"fcTL", struct.pack(">IIIIIHHBB", number, width, height, 0, 0,
                                                     round(1000 / fps), 1000, 0, 0)))
            number += 1
        # each row as its difference from the one above (filter 2), which packs well
        rows = np.zeros((height, 1 + 3 * width), np.uint8)
        flat = picture.reshape(height, -1)
        rows[:, 0] = 2
        rows[0, 1:] = flat[0]
        rows[1:, 1:] = flat[1:] - flat[:-1]
        data = zlib.compress(rows.tobytes(), 6)
        if k == 0:
            parts.append(_chunk(b"IDAT", data))
        else:
            parts.append(_chunk(b"fdAT", struct.pack(">I", number) + data))
            number += 1
    return b"".join([*parts, _chunk(b"IEND", b"")])


def in_notebook(picture: Callable[[], np.ndarray]) -> Optional[bytes]:
    """PNG of a picture; None where none can be drawn, and the notebook shows the text then."""
    try:
        return png_of([picture()])
    except (Error, RuntimeError):
        return None


def _encoded(pictures: Iterator[np.ndarray], suffix: str, fps: float, first: np.ndarray) -> tuple[bytes, int]:
    """Content of a film, and the number of its pictures."""
    if suffix == ".png":
        listed = [first, *pictures]
        return png_of(listed, fps), len(listed)
    height, width, _ = first.shape
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "film" + suffix)
        command = ["ffmpeg", "-hide_banner", "-loglevel", "error", "-y", "-f", "rawvideo",
                   "-pixel_format", "rgb24", "-video_size", f"{width}x{height}", "-framerate", str(fps),
                   "-i", "-", *_CODECS[suffix], file]
        program = subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE)
        count = 0
        assert program.stdin is not None
        try:
            for picture in (one for part in ([first], pictures) for one in part):
                program.stdin.write(picture.tobytes())
                count += 1
        except BrokenPipeError:
            pass
        except BaseException:
            program.kill()
            program.communicate()
            raise
        _, said = program.communicate()
        if program.returncode:
            raise invalid("film", "one that ffmpeg can write", said.decode(errors="replace").strip())
        return pathlib.Path(file).read_bytes(), count


def checked(file: Optional[Path], fps: float, slow: float, options: dict[str, Any]) -> str:
    """Ending of the file of a film, before anything is drawn. Without a file: what this machine can write."""
    for name, number in (("fps", fps), ("slow", slow)):
        if not 0 < number < np.inf:
            raise invalid(name, "a number above 0", number)
    found = shutil.which("ffmpeg") is not None
    suffix = (".mp4" if found else ".png") if file is None else pathlib.Path(file).suffix.lower()
    if suffix not in _TYPES:
        raise invalid("file", "a name that ends in " + ", ".join(_TYPES), repr(str(file)))
    if suffix != ".png" and not found:
        raise invalid("file", "the ffmpeg program for a film, or a name that ends in .png", repr(str(file)))
    width, height = ({**NOTEBOOK, **options}[key] for key in ("width", "height"))
    if suffix in (".mp4", ".webm") and (width % 2 or height % 2):
        raise invalid("size", "an even width and height", f"{width}x{height}")
    return suffix


def _camera(recording: Any, indices: Sequence[int], sizes: np.ndarray, field_of_view: float,
            aspect: float) -> dict[str, Any]:
    """A camera that stands still and shows all that moves: (n, 3) half sizes of the bodies [m]."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for index in indices:
        frame = recording[index]
        moves = np.array([body["motion"] != "static" for body in recording.objects(index)["bodies"]], bool)
        half = np.zeros((len(moves), 3))
        half[:len(sizes)] = sizes[:len(moves)]
        x, pad = frame.positions[moves], half[moves]
        for each in (x - pad, frame.vertices):
            low = np.minimum(low, each.min(axis=0, initial=np.inf))
        for each in (x + pad, frame.vertices):
            high = np.maximum(high, each.max(axis=0, initial=-np.inf))
    if not np.all(low <= high):
        return {}
    center, radius = (low + high) / 2, max(np.linalg.norm(high - low) / 2, 1e-3)
    up = -recording.gravity if np.any(recording.gravity) else np.array([0.0, 0.0, 1.0])
    up = up / np.linalg.norm(up)
    side = np.cross(up, [1.0, 0, 0] if abs(up[0]) < 0.9 else [0, 1.0, 0])
    side = side / np.linalg.norm(side)
    way = 0.55 * np.cross(side, up) - 0.75 * side + 0.36 * up
    angle = field_of_view * min(1.0, aspect)
    eye = center + way / np.linalg.norm(way) * radius / np.sin(angle / 2)
    return {"eye": eye, "target": center, "field_of_view": field_of_view}


def film_of(recording: Any, indices: Sequence[int], file: Optional[Path], suffix: str, fps: float,
            progress: ProgressOption, options: dict[str, Any], sizes: Optional[np.ndarray] = None) -> Film:
    """Draws frames of a recording as a film."""
    if not len(indices):
        raise invalid("frames", "one frame or more", "none")
    given: dict[str, Any] = {**NOTEBOOK, **options}
    if given.get("eye") is None and given.get("target") is None:
        none = np.zeros((0, 3)) if sizes is None else sizes
        aspect = given["width"] / given["height"]
        given.update(_camera(recording, indices, none, given.get("field_of_view", 0.6), aspect))
    with Progress(progress, "film", len(indices), "picture") as bar:
        def drawn() -> Iterator[np.ndarray]:
            for k, index in enumerate(indices):
                yield recording.render(index, **given)
                bar.update(k + 1)
        pictures = drawn()
        first = next(pictures)
        data, count = _encoded(pictures, suffix, fps, first)
    film = Film(data, suffix, first.shape[1], first.shape[0], fps, count)
    if file is not None:
        film.save(file)
    return film


class Filmed:
    """Films of a world, and its picture in a notebook."""

    def film(self, file: Optional[Path] = None, seconds: float = 3, *, fps: float = 30, slow: float = 1,
             progress: ProgressOption = None, **options: Unpack[PictureOptions]) -> Film:
        """Steps the world for `seconds` of simulated time and films it. A notebook shows the result.

        Args:
            file: .mp4, .webm, .gif, or .png (an animated PNG); None: no file. All but .png need the program
                ffmpeg, and without a file it is an animated PNG where that is missing.
            seconds: Of simulated time [s].
            fps: Pictures per second of film [1/s].
            slow: Seconds of film per simulated second.
            progress: As for `World.step`: first of the steps, then of the pictures.
            options: As for `World.render`; 640 x 360 pixels unless given. Without eye and target the camera
                stands still and shows all that moves.
        Raises:
            Error: For a file of another kind or an odd size, before the first step; without ffmpeg for a
                video; without OpenGL.
        """
        from ._recording import Recorder, Recording
        suffix, world = checked(file, fps, slow, {**options}), self._filmed()
        dt = float(world.params.dt)
        count = max(1, round(seconds * fps * slow))
        steps = [round(k / (fps * slow * dt)) for k in range(count)]
        lines = world.debug_draw(surfaces=False, bounds=True).lines
        corners = np.concatenate([lines["from"], lines["to"]], axis=1).reshape(-1, 24, 3)  # 12 edges per body
        sizes = (corners.max(axis=1) - corners.min(axis=1)) / 2
        with tempfile.TemporaryDirectory() as folder:
            name = os.path.join(folder, "film.rubble")
            with Recorder(world, name) as out, Progress(progress, "record", steps[-1]) as bar:
                out.write()
                for k in range(1, count):
                    for step in range(steps[k - 1], steps[k]):
                        report = world.step()
                        bar.update(step + 1, report.total_ms)
                    out.write()
            recording = Recording(name)
            frames = range(len(recording))
            return film_of(recording, frames, file, suffix, fps, progress, {**options}, sizes)

    def _filmed(self) -> Any:
        """The world, whose other members are those of `World`."""
        return self

    def _repr_png_(self) -> Optional[bytes]:
        return in_notebook(lambda: self._filmed().render(**NOTEBOOK))
