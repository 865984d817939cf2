"""Loads the C library, turns its status codes into exceptions, and passes texts, vectors and definitions."""
from __future__ import annotations

import ctypes
import json
import os
import pathlib
from typing import Any, Callable, Iterator, Optional, Sequence, Union

import numpy as np

from . import _abi


class Error(ValueError):
    """Invalid input. The message has the path of the field, the expected value and the found value.

    Attributes:
        path: Field, such as ``bodies[3].mass``; empty if the error is about no field.
        expected: What the field must be.
        found: What it is.
    """

    def __init__(self, message: str, path: str = "", expected: str = "", found: str = "") -> None:
        super().__init__(message)
        self.path, self.expected, self.found = path, expected, found


def invalid(path: str, expected: str, found: Any) -> Error:
    return Error(f"{path}: expected {expected}, got {found}", path, expected, str(found))


def _candidates() -> list[str]:
    folder = pathlib.Path(__file__).resolve().parent
    given = os.environ.get("RUBBLE_LIBRARY")
    beside = sorted(str(path) for path in folder.glob("librubble_c.so*"))
    return [given] if given else [*beside, "librubble_c.so.0"]


def _load() -> ctypes.CDLL:
    reasons = []
    for name in _candidates():
        try:
            library = ctypes.CDLL(name)
        except OSError as error:
            reasons.append(str(error))
            continue
        for function, (result, parameters) in _abi.FUNCTIONS.items():
            try:
                entry = getattr(library, function)
            except AttributeError:
                raise ImportError(f"{name} has no function {function}: it is of another version") from None
            entry.restype, entry.argtypes = result, parameters
        version = library.rb_api_version()
        if version != _abi.API_VERSION:
            raise ImportError(f"{name}: expected version {_abi.API_VERSION} of its interface, got {version}")
        return library
    raise ImportError("the Rubble library cannot be loaded: " + "; ".join(reasons))


lib = _load()


def last_error() -> Exception:
    """The exception for the last failed call of this thread."""
    error = lib.rb_last_error().contents
    message, path, expected, found = (
        text.decode(errors="replace") for text in (error.message, error.path, error.expected, error.found))
    if error.status == _abi.OUT_OF_MEMORY:
        return MemoryError(message)
    if error.status == _abi.FAILED:
        return RuntimeError(message)
    return Error(message, path, expected, found)


def check(status: int) -> None:
    """Raises the last error unless the status is that of success."""
    if status:
        raise last_error()


def text_of(function: Callable[..., int], *arguments: Any) -> str:
    """The text that a function returns through its last parameter."""
    out = ctypes.c_char_p()
    check(function(*arguments, ctypes.byref(out)))
    return (out.value or b"").decode()


def json_of(function: Callable[..., int], *arguments: Any) -> Any:
    return json.loads(text_of(function, *arguments))


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, np.generic):
        return value.item()
    if hasattr(value, "__array__"):
        return np.asarray(value).tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"{type(value).__name__} has no place in a definition")


def encode(definition: Any) -> bytes:
    """A definition as JSON text. Arrays become lists."""
    try:
        return json.dumps(definition, default=_plain, allow_nan=False).encode()
    except ValueError:
        expected = 'finite numbers (or the words "hard", "never", "free")'
        raise invalid("definition", expected, "an infinite number or NaN") from None


_VECTORS = {count: ctypes.c_double * count for count in (3, 4)}


def vector(value: Union[Sequence[float], np.ndarray], path: str, count: int = 3) -> ctypes.Array:
    """`count` numbers as a C array."""
    try:
        if len(value) == count:
            return _VECTORS[count](*value)
    except TypeError:
        pass
    raise invalid(path, f"{count} numbers", repr(value))


def matrix(values: Any, path: str, columns: int = 3, rows: Optional[int] = None) -> np.ndarray:
    """An array of doubles with that many columns, contiguous."""
    try:
        out = np.ascontiguousarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise invalid(path, f"an array of shape (n, {columns})", type(values).__name__) from None
    if out.ndim != 2 or out.shape[1] != columns or (rows is not None and out.shape[0] != rows):
        wanted = f"({'n' if rows is None else rows}, {columns})"
        raise invalid(path, f"an array of shape {wanted}", f"shape {out.shape}")
    return out


def structs(address: Optional[int], count: int, kind: Any) -> np.ndarray:
    """A copy of `count` C structs as a structured array."""
    dtype = np.dtype(kind)
    if not address or count == 0:
        return np.empty(0, dtype)
    return np.frombuffer(ctypes.string_at(address, count * dtype.itemsize), dtype)


def list_of(function: Callable[..., int], kind: Any, *arguments: Any) -> np.ndarray:
    """A copy of the list that a function returns through its last two parameters."""
    address, count = ctypes.c_void_p(), ctypes.c_int64()
    check(function(*arguments, ctypes.byref(address), ctypes.byref(count)))
    return structs(address.value, count.value, kind)


class Handle:
    """Owns an object of the library.

    Attributes:
        held: What the next step of a world may still read.
    """

    __slots__ = ("pointer", "held", "_destroy")

    def __init__(self, create: Callable[..., int], destroy: Callable[[Any], None], *arguments: Any) -> None:
        self._destroy = destroy
        self.held: list[Any] = []
        self.pointer = ctypes.c_void_p()
        check(create(*arguments, ctypes.byref(self.pointer)))

    def close(self) -> None:
        pointer, self.pointer = self.pointer, ctypes.c_void_p()
        if pointer:
            self._destroy(pointer)

    def __del__(self) -> None:
        self.close()


class Named:
    """What has a name for each of its elements."""

    names: list[str]

    def _at(self, name: str, what: str) -> int:
        if name not in self.names:
            raise KeyError(f"no {what} {name!r}; there are {', '.join(self.names)}")
        return self.names.index(name)

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __len__(self) -> int:
        return len(self.names)

    def __repr__(self) -> str:
        return f"<rubble.{type(self).__name__} {', '.join(self.names)}>"
