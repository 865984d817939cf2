"""Many separate worlds in one engine."""
from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, Optional, Sequence, Union

import numpy as np

from . import _abi
from ._arrays import (JOINT_NAMES, SENSOR_NAMES, VERTEX_NAMES, answer_of, cast_arrays, index_of,
                      read_array, write_rows)
from ._exchange import WORLDS
from ._film import in_notebook
from ._library import Handle, check, encode, invalid, json_of, lib, matrix
from ._progress import Progress, ProgressOption
from ._queries import RayHits, _rays, filter_of
from ._scene import Scene
from ._world import Snapshot, StepReport, World


if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._options import FilterFields, Parameters, WorldOptions


_CALL = 50.0  # how long a call of several steps may take, for Ctrl-C is seen between calls [ms]


class _OneOf:
    """Owns the handle of a world, and keeps its batch alive."""

    __slots__ = ("_batch", "_handle", "held")

    def __init__(self, batch: Handle, number: int) -> None:
        self._batch, self.held = batch, batch.held
        self._handle = Handle(lib.rb_worlds_world, lib.rb_world_destroy, batch.pointer, number)

    @property
    def pointer(self) -> Any:
        return self._handle.pointer


class Worlds:
    """Worlds that share one engine and nothing else. World i has the bits that it has alone.

    Args:
        scene: Scene of the first worlds, or none.
        count: Number of worlds of that scene.
        backend: "cpu", "reference" (double precision), or another of `info()`.
        threads: 0: one per core.
        events: Collect the events of each step.
        options: "preset", "timings", "instruction_set" and parameters by name: dt [s], iterations, substeps,
            sleeping.
    Raises:
        Error: For an invalid scene or option.

    ``worlds[i]`` is a `World` with its own ids, gravity, events and snapshots. All are used by one thread at
    a time. Steps release the interpreter lock.
    """

    def __init__(self, scene: Optional[Scene] = None, count: int = 1, *, backend: str = "cpu",
                 threads: int = 0, events: bool = False,
                 **options: Unpack[WorldOptions]) -> None:
        given = {"backend": backend, "threads": threads, "events": events, **options}
        self._handle = Handle(lib.rb_worlds_create, lib.rb_worlds_destroy, encode(given))
        self._worlds: dict[int, World] = {}
        self._step_ms = float("inf")  # of the last step
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

    def step(self, count: int = 1, active: Any = None, *, progress: ProgressOption = None) -> StepReport:
        """Advances the worlds by `count` steps of dt.

        Args:
            active: (worlds,) booleans: which worlds take part; all others keep their state. None: all.
            progress: As for `World.step`. Ctrl-C ends the call between two steps.
        Returns:
            The report of the last step: sums over the worlds that took part.
        """
        report, mask = StepReport(), None
        if active is not None:
            flags = np.ascontiguousarray(active, dtype=np.uint8)
            if flags.shape != (len(self),):
                raise invalid("active", f"shape ({len(self)},)", f"shape {flags.shape}")
            mask = flags.ctypes.data
        with Progress(progress, f"{len(self)} worlds", count) as bar:
            done = 0
            while done < count:
                most = 1 if progress else max(1, int(_CALL / max(self._step_ms, 1e-3)))
                steps = min(most, count - done)
                check(lib.rb_worlds_step(self._handle.pointer, steps, mask, ctypes.byref(report._plain)))
                done, self._step_ms = done + steps, report.total_ms
                bar.update(done, report.total_ms)
        self._handle.held.clear()
        return report

    def reset(self, worlds: Any, snapshots: Union[Snapshot, Sequence[Snapshot]]) -> None:
        """Restores distinct worlds from one snapshot each, or all of them from one, and no other world.

        Args:
            worlds: Numbers, or a mask of shape (worlds,) of booleans.
            snapshots: One, or as many as worlds, of any worlds of this batch.

        Each of these worlds begins the next episode of its random numbers (`uniform`).
        """
        numbers = self._numbers(worlds)
        given = [snapshots] if isinstance(snapshots, Snapshot) else list(snapshots)
        handles = (ctypes.c_void_p * len(given))(*(each._handle.pointer.value for each in given))
        check(lib.rb_worlds_reset(self._handle.pointer, numbers.ctypes.data, len(numbers), handles,
                                  len(given)))

    @property
    def params(self) -> dict[str, Any]:
        """All parameters by name."""
        return json_of(lib.rb_worlds_params, self._handle.pointer)

    def set_params(self, **values: Unpack[Parameters]) -> None:
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
        """A state array of the bodies of all worlds.

        Args:
            name: "position", "orientation", "velocity", "angular_velocity", "force" or "torque".
        Returns:
            (rows, numbers). Body k of world w is row ``rows(w)[k]``. Worlds of one scene have
            ``array(name).reshape(len(worlds), -1, numbers)``. A read-only numpy view, or a `DeviceArray` with
            the backend "cuda". Steps and the next call for the same array may change it: copy what lasts.
            It ends where bodies or worlds are added or removed.
        """
        return read_array(lib.rb_worlds_array, self._handle, index_of(name), WORLDS)

    def scatter(self, name: str, rows: Any, values: Any) -> None:
        """Writes ``values[k]`` to row ``rows[k]`` of an array; "force" and "torque" accumulate.

        Args:
            rows: (n,) integers without duplicates.
            values: (n, 3), or (n, 4) for "orientation".

        Both may be arrays of the device, as in `World.scatter`.
        """
        write_rows(lib.rb_worlds_scatter, self._handle, index_of(name), rows, values, WORLDS)

    def joint_array(self, name: str) -> Any:
        """`World.joint_array` of all worlds, world after world: (rows, 1). Axis k of world w has the row
        ``first_axis(w) + k``. Worlds of one scene have ``joint_array(name).reshape(len(worlds), -1)``."""
        return read_array(lib.rb_worlds_joint_array, self._handle, index_of(name, JOINT_NAMES), WORLDS)

    def sensor_array(self, name: str) -> Any:
        """`World.sensor_array` of all worlds. Rows of bodies are those of `array`; joints are world after
        world."""
        return read_array(lib.rb_worlds_sensor_array, self._handle, index_of(name, SENSOR_NAMES), WORLDS)

    def vertex_array(self, name: str) -> Any:
        """`World.vertex_array` of all worlds, world after world: (vertices, 3). The vertices of world w begin
        at row ``first_vertex(w)``, those of an object of it ``object.first_vertex`` rows later. Worlds of one
        scene have ``vertex_array(name).reshape(len(worlds), -1, 3)``."""
        return read_array(lib.rb_worlds_vertex_array, self._handle, index_of(name, VERTEX_NAMES), WORLDS)

    def first_vertex(self, world: int) -> int:
        """Row of the first vertex of a world in `vertex_array`."""
        row = ctypes.c_int32()
        check(lib.rb_worlds_first_vertex(self._handle.pointer, world, ctypes.byref(row)))
        return row.value

    def first_axis(self, world: int) -> int:
        """Row of the first axis of a world in the joint arrays."""
        row = ctypes.c_int32()
        check(lib.rb_worlds_first_axis(self._handle.pointer, world, ctypes.byref(row)))
        return row.value

    def scatter_joints(self, name: str, rows: Any, values: Any) -> None:
        """`World.scatter_joints` with rows of `joint_array` of all worlds."""
        which = index_of(name, JOINT_NAMES)
        write_rows(lib.rb_worlds_scatter_joints, self._handle, which, rows, values, WORLDS)

    def contact_forces(self, pairs: Any) -> Any:
        """Contact forces of the last step between the two bodies of each pair.

        Args:
            pairs: (n, 2) rows of `array`: two bodies of one world each.
        Returns:
            (n, 3) on the second body, world axes [N]: a copy, or a `DeviceArray` with the backend "cuda".
        """
        rows = np.ascontiguousarray(pairs, dtype=np.int32).reshape(-1, 2)
        forces = _abi.Array()
        check(lib.rb_worlds_contact_forces(self._handle.pointer, rows.ctypes.data, len(rows),
                                           ctypes.byref(forces)))
        return answer_of(forces, self._handle, WORLDS)

    def cast_rays(self, worlds: Any, origins: Any, directions: Any, max_distance: float = 1e6,
                  **filter: Unpack[FilterFields]) -> np.ndarray:
        """First hits of rays in many worlds: ray k from ``origins[k]`` [m] in world ``worlds[k]``,
        as `World.cast_rays`."""
        rays = _rays(origins, directions, max_distance, filter)
        hits = np.zeros(len(rays), np.dtype(_abi.Hit))
        numbers = np.ascontiguousarray(np.broadcast_to(worlds, len(rays)), dtype=np.int32)
        check(lib.rb_worlds_cast_rays(self._handle.pointer, numbers.ctypes.data, rays.ctypes.data, len(rays),
                                      hits.ctypes.data))
        return hits

    def cast_ray_arrays(self, origins: Any, directions: Any, max_distance: float = 1e6,
                        worlds: Any = None, **filter: Unpack[FilterFields]) -> RayHits:
        """`World.cast_ray_arrays` in many worlds.

        Args:
            worlds: (n,) world of each ray, int32, in the same memory. None: each world has as many rays,
                world after world.
            filter: `ignore` skips the body of that index in each world.
        """
        given = {"origins": origins, "directions": directions, "worlds": worlds}
        return RayHits(*cast_arrays(lib.rb_worlds_cast_ray_arrays, self._handle, given, max_distance,
                                    filter_of(**filter), WORLDS))

    def set_values(self, key: str, values: Any, worlds: Any = None) -> None:
        """Sets an authored value of each world: domain randomization. A reset brings back that of its
        snapshot.

        Args:
            key: A list, a name and keys of scene files: "gravity", "bodies.cart.material.friction",
                "joints.hip.axes.0.drive_stiffness", "deformables.rope.density", "attachments.tip.stiffness",
                "actuators.motor.gain", "materials.ice.friction", "material_pairs.ice.steel.friction". A name
                with a dot is in brackets and quotes: ``bodies["a.b"].mass``. A number in brackets is a place
                in `World.bodies`, `World.joints` and so on: ``bodies[3].mass``.
            values: (n,) numbers, or (n, m) for values of m numbers.
            worlds: n numbers, or a mask of shape (worlds,). None: all.
        Raises:
            Error: For an unknown name or key, or an invalid value, with the world in its path. No world has
                changed then.
        """
        numbers = self._numbers(worlds)
        given = np.ascontiguousarray(values, dtype=np.float64)
        if given.ndim not in (1, 2) or len(given) != len(numbers):
            raise invalid("values", f"one per world, {len(numbers)}", f"shape {given.shape}")
        width = given.shape[1] if given.ndim > 1 else 1
        check(lib.rb_worlds_set_values(self._handle.pointer, key.encode(), numbers.ctypes.data, len(numbers),
                                       given.ctypes.data, width))

    def values(self, key: str, worlds: Any = None) -> np.ndarray:
        """Present values of a key of `set_values`, a copy: (n,) numbers, or (n, m) for m numbers each."""
        numbers = self._numbers(worlds)
        address, count = ctypes.c_void_p(), ctypes.c_int64()
        check(lib.rb_worlds_values(self._handle.pointer, key.encode(), numbers.ctypes.data, len(numbers),
                                   ctypes.byref(address), ctypes.byref(count)))
        if not count.value:
            return np.empty(0)
        found = np.frombuffer(ctypes.string_at(address, 8 * count.value))
        return found if len(found) == len(numbers) else found.reshape(len(numbers), -1)

    def set_seed(self, seed: int, worlds: Any = None) -> None:
        """Gives each world random numbers of its own, made of `seed` and its number, and begins with their
        episode 0. Worlds begin with a seed of 0.

        Args:
            worlds: Numbers, or a mask of shape (worlds,). None: all, and those that are added later.
        """
        numbers = None if worlds is None else self._numbers(worlds)
        check(lib.rb_worlds_set_seed(self._handle.pointer, seed & 0xFFFFFFFFFFFFFFFF,
                                     None if numbers is None else numbers.ctypes.data,
                                     0 if numbers is None else len(numbers)))

    def uniform(self, worlds: Any = None, count: int = 1, low: float = 0, high: float = 1) -> np.ndarray:
        """The next `count` random numbers of worlds, from `low` to below `high`.

        Number k of an episode of a world is a hash of its seed, the episode and k. Draws and resets of other
        worlds have no effect on it. `reset` begins the next episode of a world.

        Args:
            worlds: n numbers, or a mask of shape (worlds,). None: all.
        Returns:
            (n, count) numbers.
        """
        numbers = self._numbers(worlds)
        drawn = np.empty((len(numbers), max(count, 0)))
        check(lib.rb_worlds_uniform(self._handle.pointer, numbers.ctypes.data, len(numbers), count, low, high,
                                    drawn.ctypes.data))
        return drawn

    def random_state(self, world: int) -> tuple[int, int, int]:
        """Where the random numbers of a world stand: its seed, its resets since the seed was set, and the
        numbers drawn since the last of these."""
        seed, episode, drawn = ctypes.c_uint64(), ctypes.c_int64(), ctypes.c_int64()
        check(lib.rb_worlds_random_state(self._handle.pointer, world, ctypes.byref(seed),
                                         ctypes.byref(episode), ctypes.byref(drawn)))
        return seed.value, episode.value, drawn.value

    def set_random_state(self, world: int, state: Sequence[int]) -> None:
        """Continues the random numbers of a world from a `random_state`, of any world."""
        seed, episode, drawn = state
        check(lib.rb_worlds_set_random_state(self._handle.pointer, world, seed, episode, drawn))

    def _numbers(self, worlds: Any) -> np.ndarray:
        """Numbers of worlds, of those of a mask, or of all."""
        numbers = np.arange(len(self)) if worlds is None else np.asarray(worlds)
        if numbers.dtype == bool:
            numbers = np.flatnonzero(numbers)
        return np.ascontiguousarray(numbers, dtype=np.int32).reshape(-1)

    @property
    def memory_bytes(self) -> int:
        """Memory of the tables of the engine [bytes]."""
        return lib.rb_worlds_memory_bytes(self._handle.pointer)

    def _repr_png_(self) -> Optional[bytes]:
        """The first worlds, up to four, beside one another."""
        if not len(self):
            return None
        return in_notebook(lambda: np.hstack([self[k].render(320, 240) for k in range(min(4, len(self)))]))

    def __repr__(self) -> str:
        return f"<rubble.Worlds {len(self)}>"
