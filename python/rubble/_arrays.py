"""Views of the state of all bodies, without copies."""
from __future__ import annotations

import ctypes
import functools
from typing import Any, Optional

import numpy as np

from . import _abi
from ._exchange import CPU, CUDA, WORLD, Functions, capsule_of, device_of, interface_of, view_of
from ._library import check, invalid, lib

NAMES = ("position", "orientation", "velocity", "angular_velocity", "force", "torque")
JOINT_NAMES = ("position", "speed", "drive_force", "limit_force", "friction_force", "lower_limit",
               "upper_limit", "target_position", "target_speed", "applied_force")
SENSOR_NAMES = ("contact_force", "touch", "acceleration", "angular_rate", "joint_force", "joint_torque")
VERTEX_NAMES = ("position", "velocity")


def index_of(name: str, names: tuple[str, ...] = NAMES) -> int:
    """Number of an array among those of its kind."""
    try:
        return names.index(name)
    except ValueError:
        raise invalid("array", "one of " + ", ".join(names), repr(name)) from None


class _Source:
    """What numpy reads an interface of. An array that views it keeps `owner` alive."""

    def __init__(self, interface: dict[str, Any], owner: Any = None) -> None:
        self.__array_interface__, self._owner = interface, owner


class _Exchanged:
    """What arrays have in common: their layout, and the protocols of libraries for device memory."""

    __slots__ = ("_owner", "_view", "_functions")

    _owner: Any
    _view: _abi.Array
    _functions: Functions

    def _update(self) -> None:
        """Applies pending edits, so that a reader finds them."""

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and numbers per row."""
        return tuple(self._view.shape)

    @property
    def strides(self) -> tuple[int, int]:
        """Distance between rows and between numbers [bytes]."""
        return tuple(self._view.strides)

    @property
    def ndim(self) -> int:
        """2."""
        return 2

    @property
    def dtype(self) -> np.dtype:
        """Type of the numbers: float64 for positions, float32 for the others. All are float64 with the
        backend "reference"."""
        return np.dtype(self._view.typestr.decode())

    @property
    def on_device(self) -> bool:
        """Whether the data lie in GPU memory."""
        return bool(self._view.device)

    @property
    def __cuda_array_interface__(self) -> dict[str, Any]:
        if not self.on_device:
            raise AttributeError("the array is in host memory: use numpy.asarray")
        self._update()
        return interface_of(self._view)

    def __array__(self, dtype: Any = None, copy: Optional[bool] = None) -> np.ndarray:
        if self.on_device:
            raise TypeError("the array is in device memory: use a library for GPUs")
        out = np.asarray(self, dtype=dtype)  # by __array_interface__
        return out.copy() if copy else out

    def __dlpack_device__(self) -> tuple[int, int]:
        """Type and number of the device, as in DLPack: (1, 0) for the host, (2, number) for a GPU."""
        return (CUDA, device_of(self._functions, self._owner.pointer)[0]) if self.on_device else (CPU, 0)

    def __dlpack__(self, *, stream: Optional[int] = None, max_version: Any = None,
                   dl_device: Optional[tuple[int, int]] = None, copy: Optional[bool] = None) -> Any:
        """A DLPack capsule. Do not write to it: writes go through `scatter`.

        Args:
            stream: Reads the array: None or 1 for the legacy default stream, 2 for that of the thread, or a
                handle. Its later work waits for the engine. Until the tensor is freed, what the engine writes
                waits for the work of the stream, which must exist until then. -1: nothing is ordered.
        Raises:
            BufferError: For another device, a copy, or a stream of an array in host memory.
        """
        if copy:
            raise BufferError("a view is never a copy: copy the result")
        if dl_device is not None and tuple(map(int, dl_device)) != self.__dlpack_device__():
            raise BufferError("a view stays on its device: copy the result")
        self._update()
        return capsule_of(self._functions, self._owner.pointer, self._view, stream)

    def __len__(self) -> int:
        return self._view.shape[0]

    def __repr__(self) -> str:
        place = "device" if self.on_device else "host"
        return f"<rubble.{type(self).__name__} {self._name()}{self.shape} {self.dtype} on {place}>"

    def _name(self) -> str:
        return ""


class DeviceArray(_Exchanged):
    """A read-only array in device memory, for PyTorch, JAX, CuPy, Warp and others.

    They take it by ``__dlpack__`` or ``__cuda_array_interface__``, without a copy. It is valid until the next
    call for the same array.
    """

    __slots__ = ()

    def __init__(self, owner: Any, view: _abi.Array, functions: Functions = WORLD) -> None:
        self._owner, self._view, self._functions = owner, view, functions


def read_array(call: Any, owner: Any, which: int, functions: Functions = WORLD) -> Any:
    """What call(owner, which, array) describes: a read-only numpy view, or a `DeviceArray`."""
    view = _abi.Array()
    check(call(owner.pointer, which, ctypes.byref(view)))
    if view.device or not view.data:
        return answer_of(view, owner, functions)
    return np.asarray(_Source(_host_interface(view), owner))


def answer_of(view: _abi.Array, owner: Any, functions: Functions = WORLD) -> Any:
    """The array of an answer to a query: a copy of host memory, or a `DeviceArray`."""
    if view.device:
        return DeviceArray(owner, view, functions)
    return _copy_of(view) if view.data else np.empty(tuple(view.shape), view.typestr.decode())


def cast_arrays(call: Any, owner: Any, given: dict[str, Any], max_distance: float, filter: Any,
                functions: Functions = WORLD) -> list[Any]:
    """call(owner, worlds, rays, hits) with "origins", "directions" and "worlds", or None, of `given`. Returns
    distances, bodies and normals as `answer_of` does."""
    keep: list[Any] = []
    used: list[Any] = []
    device = functools.partial(device_of, functions, owner.pointer)
    views = {}
    for name, values in given.items():
        kind = np.int32 if name == "worlds" else np.float64
        views[name] = None if values is None else view_of(name, values, kind, device, keep, used)
    rays, hits = _abi.RayArrays(), _abi.RayHitArrays()
    rays.origins, rays.directions, rays.max_distance = views["origins"], views["directions"], max_distance
    rays.filter = filter
    owner.held.extend(used)  # as those of write_rows()
    worlds = views["worlds"]
    check(call(owner.pointer, None if worlds is None else ctypes.byref(worlds), ctypes.byref(rays),
               ctypes.byref(hits)))
    return [answer_of(view, owner, functions) for view in (hits.distances, hits.bodies, hits.normals)]


def write_rows(call: Any, owner: Any, which: int, rows: Any, values: Any,
               functions: Functions = WORLD) -> None:
    """call(owner, which, rows, values) with both as C arrays."""
    keep: list[Any] = []
    used: list[Any] = []
    device = functools.partial(device_of, functions, owner.pointer)
    row_view = view_of("rows", rows, np.int32, device, keep, used)
    value_view = view_of("values", values, np.float64, device, keep, used)
    # the device reads later, but at the latest in the next step
    owner.held.extend(used)
    check(call(owner.pointer, which, ctypes.byref(row_view), ctypes.byref(value_view)))


class Array(_Exchanged):
    """A read-only view of one state array of a world, one row per body slot.

    Others take it without a copy: ``numpy.asarray(a)`` for host memory, ``__dlpack__`` and
    ``__cuda_array_interface__`` for libraries such as PyTorch, JAX, CuPy and Warp. It is valid while
    ``world.epoch`` is unchanged.
    """

    __slots__ = ("_which",)

    def __init__(self, owner: Any, which: int) -> None:
        # the owner of the C world alone, so that a world that caches its views is no cycle of references
        self._owner, self._which, self._view, self._functions = owner, which, _abi.Array(), WORLD
        self._update()

    def _update(self) -> None:
        check(lib.rb_world_array(self._owner.pointer, self._which, ctypes.byref(self._view)))

    @property
    def __array_interface__(self) -> dict[str, Any]:
        if self.on_device:
            raise AttributeError("the array is in device memory: use __cuda_array_interface__ or __dlpack__")
        return _host_interface(self._view)

    def _name(self) -> str:
        return f"{NAMES[self._which]} "


class StateArrays:
    """The arrays of a world, as properties. numpy arrays on the CPU, `Array` objects on a GPU."""

    _owner: Any
    _pointer: ctypes.c_void_p
    _view: _abi.Array
    _view_reference: Any
    _views: list[Any]
    _epoch: int

    def _array(self, which: int) -> Any:
        # on the CPU this also applies pending edits, so that they are seen
        status = lib.rb_world_array(self._pointer, which, self._view_reference)
        if status:
            check(status)
        epoch = self._view.epoch
        if epoch != self._epoch:
            self._views, self._epoch = [None] * len(NAMES), epoch
        found = self._views[which]
        if found is None:
            view = Array(self._owner, which)
            found = self._views[which] = view if view.on_device else np.asarray(view)
        return found

    def array(self, name: str) -> Array:
        """One of "position", "orientation", "velocity", "angular_velocity", "force", "torque" as `Array`."""
        return Array(self._owner, index_of(name))

    @property
    def positions(self) -> Any:
        """Centers of mass [m]: (N, 3) doubles, read-only view, row ``body.index``. Rows of removed bodies
        keep their last values. Read the property again after bodies were added, removed or sorted."""
        return self._array(0)

    @property
    def orientations(self) -> Any:
        """Principal axes -> world: (N, 4) quaternions, scalar first; see `positions`."""
        return self._array(1)

    @property
    def velocities(self) -> Any:
        """Velocities of the centers of mass [m/s]: (N, 3); see `positions`."""
        return self._array(2)

    @property
    def angular_velocities(self) -> Any:
        """Angular velocities, world axes [rad/s]: (N, 3); see `positions`."""
        return self._array(3)

    @property
    def forces(self) -> Any:
        """Forces for the next step [N]: (N, 3); see `positions`."""
        return self._array(4)

    @property
    def torques(self) -> Any:
        """Torques for the next step [N m]: (N, 3); see `positions`."""
        return self._array(5)

    @property
    def epoch(self) -> int:
        """A number that changes when array views become invalid."""
        return lib.rb_world_epoch(self._pointer)

    def scatter(self, name: str, rows: Any, values: Any) -> None:
        """Writes ``values[k]`` to row ``rows[k]`` of an array; "force" and "torque" accumulate.

        Args:
            name: As for `array`.
            rows: (n,) integers without duplicates, ``body.index``.
            values: (n, 3), or (n, 4) for "orientation". Both arguments are host arrays, or with the backend
                "cuda" both arrays of its device, with ``__cuda_array_interface__`` or ``__dlpack__``.
                Those are read in the order of their stream, and may be overwritten in it afterwards.
        Raises:
            Error: For a wrong shape or a number that is not finite.
        """
        write_rows(lib.rb_world_scatter, self._owner, index_of(name), rows, values)

    def axes(self) -> list[tuple[int, int]]:
        """(joint.index, axis) of each row of the joint arrays."""
        joints, axes, count = ctypes.c_void_p(), ctypes.c_void_p(), ctypes.c_int64()
        check(lib.rb_world_axes(self._pointer, ctypes.byref(joints), ctypes.byref(axes), ctypes.byref(count)))
        if not count.value:
            return []
        ids = ctypes.cast(joints, ctypes.POINTER(_abi.JointId))
        numbers = ctypes.cast(axes, ctypes.POINTER(ctypes.c_int32))
        return [(ids[k].index, numbers[k]) for k in range(count.value)]

    def joint_array(self, name: str) -> Any:
        """An array of the joints, one row per axis of each joint (see `axes`).

        Args:
            name: "position", "speed", "drive_force", "limit_force", "friction_force", "lower_limit",
                "upper_limit", "target_position" or "target_speed", in [m], [rad], [N], [N m].
        Returns:
            (axes, 1): a read-only view, or a `DeviceArray` with the backend "cuda". Steps and the next call
            for the same array may change it. Forces act on body A along the axis.
        """
        return read_array(lib.rb_world_joint_array, self._owner, index_of(name, JOINT_NAMES))

    def sensor_array(self, name: str) -> Any:
        """What sensors measure.

        Args:
            name: By body: "contact_force" (3, world axes [N]), "touch" (1, sum of normal forces [N]),
                "acceleration" (3, less gravity, body axes [m/s2]), "angular_rate" (3, body axes [rad/s]).
                By joint: "joint_force" (3 [N]), "joint_torque" (3 [N m]), on body B, world axes.
        Returns:
            (rows, numbers), as `joint_array`. Body axes are those of `orientations`.
        """
        return read_array(lib.rb_world_sensor_array, self._owner, index_of(name, SENSOR_NAMES))

    def vertex_array(self, name: str) -> Any:
        """An array of the vertices of all deformable objects, in the order in which the objects were added.

        Args:
            name: "position" [m] or "velocity" [m/s].
        Returns:
            (vertices, 3), as `joint_array`. Those of an object begin at row ``object.first_vertex``.
        """
        return read_array(lib.rb_world_vertex_array, self._owner, index_of(name, VERTEX_NAMES))

    def scatter_joints(self, name: str, rows: Any, values: Any) -> None:
        """Writes ``values[k]`` to row ``rows[k]`` of a joint array.

        Args:
            name: "target_position" [m], [rad], "target_speed" [m/s], [rad/s], or "applied_force" [N], [N m]
                for the next step.
            rows: (n,) integers without duplicates.
            values: (n,) numbers.
        """
        write_rows(lib.rb_world_scatter_joints, self._owner, index_of(name, JOINT_NAMES), rows, values)

    def begin_poses(self) -> None:
        """Starts a copy of the present poses to the host. At most two may be pending."""
        check(lib.rb_world_begin_poses(self._pointer))

    def poses_ready(self) -> bool:
        """Whether the oldest pending copy is complete. Never waits."""
        return bool(lib.rb_world_poses_ready(self._pointer))

    def take_poses(self) -> tuple[float, np.ndarray, np.ndarray]:
        """Waits for the oldest pending copy: time [s], positions (N, 3) [m] and orientations (N, 4)."""
        frame = _abi.PoseFrame()
        check(lib.rb_world_take_poses(self._pointer, ctypes.byref(frame)))
        return frame.time, *(_copy_of(view) for view in (frame.position, frame.orientation))

    def sort_bodies(self) -> None:
        """Sorts the bodies in memory by position, with the next step. Results are unchanged."""
        check(lib.rb_world_sort_bodies(self._pointer))


def _host_interface(view: _abi.Array) -> dict[str, Any]:
    return {"data": (view.data or 0, True), "shape": tuple(view.shape), "strides": tuple(view.strides),
            "typestr": view.typestr.decode(), "version": 3}


def _copy_of(view: _abi.Array) -> np.ndarray:
    return np.array(_Source(_host_interface(view)))
