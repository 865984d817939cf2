"""Many separate worlds in one engine."""
from __future__ import annotations

import ctypes
from typing import Any, Optional, Sequence, Union

import numpy as np

from . import _abi
from ._arrays import _copy_of, _view_of, index_of
from ._library import Handle, check, encode, invalid, json_of, lib
from ._scene import Scene
from ._world import Snapshot, StepReport, World


class _OneOf:
    """Owns the handle of a world, and keeps its batch alive."""

    __slots__ = ("_batch", "_handle")

    def __init__(self, batch: Handle, number: int) -> None:
        self._batch = batch
        self._handle = Handle(lib.rb_worlds_world, lib.rb_world_destroy, batch.pointer, number)

    @property
    def pointer(self) -> Any:
        return self._handle.pointer


class Worlds:
    """Worlds that share one engine and nothing else. World i has the bits that it has alone.

    Args:
        scene: Scene of the first worlds, or none.
        count: Number of worlds of that scene.
        backend: "cpu" or "reference" (double precision).
        threads: 0: one per core.
        events: Collect the events of each step.
        options: "preset", "timings" and parameters by name: dt [s], iterations, substeps, sleeping.
    Raises:
        Error: For an invalid scene or option.

    ``worlds[i]`` is a `World` with its own ids, gravity, events and snapshots. All are used by one thread at
    a time. Steps release the interpreter lock.
    """

    def __init__(self, scene: Optional[Scene] = None, count: int = 1, *, backend: str = "cpu",
                 threads: int = 0, events: bool = False, **options: Any) -> None:
        given = {"backend": backend, "threads": threads, "events": events, **options}
        self._handle = Handle(lib.rb_worlds_create, lib.rb_worlds_destroy, encode(given))
        self._worlds: dict[int, World] = {}
        if scene is not None:
            self.add(scene, count)

    def add(self, scene: Scene, count: int = 1) -> int:
        """Adds `count` worlds of a scene and returns the number of the first."""
        first = ctypes.c_int32()
        check(lib.rb_worlds_add(self._handle.pointer, scene._pointer, count, ctypes.byref(first)))
        return first.value

    def __len__(self) -> int:
        return lib.rb_worlds_count(self._handle.pointer)

    def __getitem__(self, number: int) -> World:
        """World `number`, from 0; negative numbers count from the end."""
        if not -len(self) <= number < len(self):
            raise IndexError(f"world {number} of {len(self)}")
        number %= len(self)
        found = self._worlds.get(number)
        if found is None:
            found = self._worlds[number] = World.__new__(World)
            found._own(_OneOf(self._handle, number))
        return found

    def step(self, count: int = 1, active: Any = None) -> StepReport:
        """Advances the worlds by `count` steps of dt.

        Args:
            active: (worlds,) booleans: which worlds take part; all others keep their state. None: all.
        Returns:
            The report of the last step: sums over the worlds that took part.
        """
        report, mask = StepReport(), None
        if active is not None:
            flags = np.ascontiguousarray(active, dtype=np.uint8)
            if flags.shape != (len(self),):
                raise invalid("active", f"shape ({len(self)},)", f"shape {flags.shape}")
            mask = flags.ctypes.data
        for _ in range(count):
            check(lib.rb_worlds_step(self._handle.pointer, 1, mask, ctypes.byref(report._plain)))
        return report

    def reset(self, worlds: Any, snapshots: Union[Snapshot, Sequence[Snapshot]]) -> None:
        """Restores distinct worlds from one snapshot each, or all of them from one, and no other world.

        Args:
            worlds: Numbers, or a mask of shape (worlds,) of booleans.
            snapshots: One, or as many as worlds, of any worlds of this batch.
        """
        numbers = np.asarray(worlds)
        if numbers.dtype == bool:
            numbers = np.flatnonzero(numbers)
        numbers = np.ascontiguousarray(numbers, dtype=np.int32).reshape(-1)
        given = [snapshots] if isinstance(snapshots, Snapshot) else list(snapshots)
        handles = (ctypes.c_void_p * len(given))(*(each._handle.pointer.value for each in given))
        check(lib.rb_worlds_reset(self._handle.pointer, numbers.ctypes.data, len(numbers), handles,
                                  len(given)))

    @property
    def params(self) -> dict[str, Any]:
        """All parameters by name."""
        return json_of(lib.rb_worlds_params, self._handle.pointer)

    def set_params(self, **values: Any) -> None:
        """Sets parameters of all worlds. Raises `Error` for an unknown name or a value out of range."""
        check(lib.rb_worlds_set_params(self._handle.pointer, encode(values)))

    def rows(self, world: int) -> np.ndarray:
        """Rows of the bodies of a world in `array`: (bodies,) integers, a copy."""
        address, count = ctypes.c_void_p(), ctypes.c_int64()
        check(lib.rb_worlds_rows(self._handle.pointer, world, ctypes.byref(address), ctypes.byref(count)))
        if not count.value:
            return np.empty(0, np.int32)
        return np.frombuffer(ctypes.string_at(address, 4 * count.value), np.int32)

    def array(self, name: str) -> np.ndarray:
        """A state array of the bodies of all worlds: a read-only copy.

        Args:
            name: "position", "orientation", "velocity", "angular_velocity", "force" or "torque".
        Returns:
            (rows, numbers). Body k of world w is row ``rows(w)[k]``. Worlds of one scene have
            ``array(name).reshape(len(worlds), -1, numbers)``.
        """
        view = _abi.Array()
        check(lib.rb_worlds_array(self._handle.pointer, index_of(name), ctypes.byref(view)))
        return _copy_of(view)

    def scatter(self, name: str, rows: Any, values: Any) -> None:
        """Writes ``values[k]`` to row ``rows[k]`` of an array; "force" and "torque" accumulate.

        Args:
            rows: (n,) integers without duplicates.
            values: (n, 3), or (n, 4) for "orientation".
        """
        keep: list[Any] = []
        row_view, value_view = _view_of(rows, np.int32, keep), _view_of(values, np.float64, keep)
        check(lib.rb_worlds_scatter(self._handle.pointer, index_of(name), ctypes.byref(row_view),
                                    ctypes.byref(value_view)))

    @property
    def memory_bytes(self) -> int:
        """Memory of the tables of the engine [bytes]."""
        return lib.rb_worlds_memory_bytes(self._handle.pointer)

    def __repr__(self) -> str:
        return f"<rubble.Worlds {len(self)}>"
