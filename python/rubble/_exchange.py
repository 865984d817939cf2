"""Arrays of this library for others, and arrays of others for this library: DLPack and array interfaces."""
from __future__ import annotations

import ctypes
import functools
import sys
from typing import Any, Callable, NamedTuple, Optional

import numpy as np

from . import _abi
from ._library import check, invalid, lib

CPU, CUDA, CUDA_HOST, CUDA_MANAGED = 1, 2, 3, 13  # device types of DLPack
LEGACY = 1  # the default stream of CUDA, as array interfaces name it
_KINDS = {0: "i", 1: "u", 2: "f"}  # of numbers, in DLPack and in typestr
_TENSOR, _VERSIONED = b"dltensor", b"dltensor_versioned"
_VERSION = (1, 0)  # the newest of DLPack whose layout is known here

_new_capsule = ctypes.pythonapi.PyCapsule_New
_new_capsule.restype = ctypes.py_object
_new_capsule.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]
# a destructor passes the address of its capsule, as which it must not be an object again
_is_valid = ctypes.PYFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_char_p)(
    ("PyCapsule_IsValid", ctypes.pythonapi))
_pointer_of = ctypes.PYFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p, ctypes.c_char_p)(
    ("PyCapsule_GetPointer", ctypes.pythonapi))


@ctypes.PYFUNCTYPE(None, ctypes.c_void_p)
def _delete_capsule(capsule: int) -> None:
    if _is_valid(capsule, _TENSOR):  # a consumer that takes the tensor over renames the capsule
        lib.rb_dlpack_delete(_pointer_of(capsule, _TENSOR))


class _Tensor(ctypes.Structure):
    _fields_ = [("data", ctypes.c_void_p), ("device_type", ctypes.c_int32), ("device", ctypes.c_int32),
                ("dimensions", ctypes.c_int32), ("code", ctypes.c_uint8), ("bits", ctypes.c_uint8),
                ("lanes", ctypes.c_uint16), ("shape", ctypes.POINTER(ctypes.c_int64)),
                ("strides", ctypes.POINTER(ctypes.c_int64)), ("byte_offset", ctypes.c_uint64)]


class _VersionedTensor(ctypes.Structure):
    _fields_ = [("major", ctypes.c_uint32), ("minor", ctypes.c_uint32), ("context", ctypes.c_void_p),
                ("deleter", ctypes.c_void_p), ("flags", ctypes.c_uint64), ("tensor", _Tensor)]


class Functions(NamedTuple):
    """The functions by which a kind of owner exchanges its arrays."""
    device: Callable[..., int]
    dlpack_of: Callable[..., int]


WORLD = Functions(lib.rb_world_device, lib.rb_world_dlpack_of)
WORLDS = Functions(lib.rb_worlds_device, lib.rb_worlds_dlpack_of)


def device_of(functions: Functions, pointer: Any) -> tuple[int, int]:
    """CUDA device of the arrays of a world and stream of its engine; -1 and 0 if they are in host memory."""
    device, stream = ctypes.c_int32(), ctypes.c_uint64()
    check(functions.device(pointer, ctypes.byref(device), ctypes.byref(stream)))
    return device.value, stream.value


# PyTorch 2.11 never frees the values of an interface that torch.as_tensor has read (pytorch/pytorch#194877),
# so those of the same array are the same objects.
@functools.lru_cache(maxsize=1024)
def _device_interface(data: int, shape: tuple[int, ...], strides: tuple[int, ...], typestr: bytes,
                      stream: int) -> dict[str, Any]:
    # memory of a device is not flagged as read-only, which PyTorch refuses
    return {"data": (data, False), "shape": shape, "strides": strides, "typestr": typestr.decode(),
            "version": 3, "stream": stream or None}


def interface_of(view: _abi.Array) -> dict[str, Any]:
    """The ``__cuda_array_interface__`` of an array in device memory."""
    return _device_interface(view.data or 0, tuple(view.shape), tuple(view.strides), view.typestr,
                             view.stream or 0)


def _reading_stream(view: _abi.Array, stream: Optional[int]) -> int:
    """The stream of ``__dlpack__`` as the library takes it: 0 for one that the consumer orders itself."""
    if not view.device:
        if stream is not None:
            raise BufferError("an array in host memory has no stream")
        return 0
    if stream is None:
        return LEGACY
    if stream == 0:
        raise BufferError("stream 0 is ambiguous: 1 is the legacy default stream, 2 that of each thread")
    return 0 if stream == -1 else stream


def capsule_of(functions: Functions, pointer: Any, view: _abi.Array, stream: Optional[int]) -> Any:
    """An array of a world as a DLPack capsule, for a consumer on a stream."""
    tensor = ctypes.c_void_p()
    check(functions.dlpack_of(pointer, ctypes.byref(view), _reading_stream(view, stream),
                              ctypes.byref(tensor)))
    return _new_capsule(tensor, _TENSOR, ctypes.cast(_delete_capsule, ctypes.c_void_p))


def _stream_of(path: str, values: Any, interface: dict[str, Any]) -> Optional[int]:
    """The stream that uses the memory of an interface, 0 if none is to be ordered, None if it is unknown."""
    if "stream" in interface:
        stream = interface["stream"]
        if stream == 0:
            raise invalid(f"{path}.stream", "None, 1, 2 or a handle", 0)
        return stream or 0
    torch = sys.modules.get("torch")
    if torch is not None and isinstance(values, torch.Tensor):  # its interface has no stream: it is this one
        return torch.cuda.current_stream(values.device).cuda_stream or LEGACY
    return None


def _tensor_in(capsule: Any) -> _Tensor:
    """The tensor of a capsule, valid while the capsule exists."""
    if _is_valid(id(capsule), _VERSIONED):
        found = _VersionedTensor.from_address(_pointer_of(id(capsule), _VERSIONED))
        if found.major > _VERSION[0]:
            raise BufferError(f"DLPack {found.major}.{found.minor} is newer than {_VERSION[0]}")
        return found.tensor
    if not _is_valid(id(capsule), _TENSOR):
        raise BufferError("__dlpack__ gave no tensor, or one that is used up")
    return _Tensor.from_address(_pointer_of(id(capsule), _TENSOR))


def _interface_in(path: str, capsule: Any) -> dict[str, Any]:
    """The tensor of a capsule in device memory as an array interface."""
    tensor = _tensor_in(capsule)
    if tensor.code not in _KINDS or tensor.lanes != 1:
        raise invalid(path, "integers or floating-point numbers", f"type code {tensor.code}")
    size = tensor.bits // 8
    strides = tuple(size * k for k in tensor.strides[:tensor.dimensions]) if tensor.strides else None
    return {"data": ((tensor.data or 0) + tensor.byte_offset, True), "strides": strides,
            "shape": tuple(tensor.shape[:tensor.dimensions]), "typestr": f"<{_KINDS[tensor.code]}{size}"}


def _capsule_from(path: str, values: Any, device: tuple[int, int]) -> Any:
    """The DLPack capsule of an array in device memory, safe to read on the stream of the engine."""
    number = values.__dlpack_device__()[1]
    if device[0] < 0:
        raise invalid(path, "host memory", "memory of a device")
    if number != device[0]:
        raise invalid(path, f"memory of device {device[0]}", f"memory of device {number}")
    try:
        return values.__dlpack__(stream=device[1], max_version=_VERSION)
    except TypeError:  # from before versions
        return values.__dlpack__(stream=device[1])


def _device_memory(path: str, values: Any, device: Callable[[], tuple[int, int]],
                   keep: list[Any]) -> Optional[dict[str, Any]]:
    """The interface of values in device memory, with "stream" as `_stream_of`. None for host memory."""
    if isinstance(values, (np.ndarray, list, tuple)):
        return None
    interface = getattr(values, "__cuda_array_interface__", None)
    stream = None if interface is None else _stream_of(path, values, interface)
    if stream is None and hasattr(values, "__dlpack__"):
        kind = int(values.__dlpack_device__()[0])
        if kind in (CUDA, CUDA_MANAGED):
            keep.append(_capsule_from(path, values, device()))
            return {**_interface_in(path, keep[-1]), "stream": LEGACY}
        if kind not in (CPU, CUDA_HOST):
            raise invalid(path, "memory of the host or of a CUDA device", f"device type {kind} of DLPack")
    if interface is None:
        return None
    if interface.get("mask") is not None:
        raise invalid(path, "an array without a mask", "one with a mask")
    return {**interface, "stream": LEGACY if stream is None else stream}


def _host_memory(values: Any, kind: Any) -> np.ndarray:
    host = np.asarray(values)
    if host.dtype == object and hasattr(values, "__dlpack__"):  # it has no other protocol
        host = np.from_dlpack(values)
    return host if kind is not np.int32 and host.dtype == np.float32 else np.asarray(host, dtype=kind)


def view_of(path: str, values: Any, kind: Any, device: Callable[[], tuple[int, int]], keep: list[Any],
            used: list[Any]) -> _abi.Array:
    """The C description of an array.

    Args:
        path: What it is, for errors.
        kind: Type of numbers in host memory.
        device: Gives what `device_of` gives.
        keep: Takes what owns the memory in host memory.
        used: Takes what owns memory that no stream of its own frees in order.
    """
    described = _device_memory(path, values, device, used)
    on_device = described is not None
    if described is None:
        host = _host_memory(values, kind)
        keep.append(host)
        described = dict(host.__array_interface__, strides=host.strides)
    shape, typestr = tuple(described["shape"]), described["typestr"]
    if not 1 <= len(shape) <= 2:
        raise invalid(f"{path}.shape", "1 or 2 dimensions", shape)
    size = int(typestr[2:])
    shape = shape if len(shape) > 1 else (*shape, 1)
    strides = described.get("strides") or (shape[1] * size, size)
    view = _abi.Array()
    view.data, view.typestr = described["data"][0], typestr.encode()
    view.shape, view.strides = shape, tuple(strides) if len(strides) > 1 else (*strides, size)
    view.device, view.stream = on_device, described.get("stream") or 0
    return view
