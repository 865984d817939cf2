"""A running simulation."""
from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, Iterator

import numpy as np

from . import _abi
from ._arrays import NAMES, StateArrays
from ._bodies import Bodies, Body, Shapes, Vector
from ._film import Filmed
from ._joints import Joints
from ._library import Handle, check, encode, json_of, lib, text_of, vector
from ._picture import View
from ._progress import Progress, ProgressOption
from ._queries import Queries
from ._scene import Scene
from ._soft import Attachments, Deformable, Deformables

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._fields import MaterialPair
    from ._options import Parameters, WorldOptions


class StepReport:
    """Report of a step.

    Attributes: step, bodies, pairs, manifolds, contacts, vertices, vertex_contacts, colors, clashes,
    broken_joints, sleeping_bodies, stopped_bodies, quarantined, failed_solves, restarts, sorted,
    unfinished_motion [1] and total_ms [ms]. ``World.report`` has the lists as well.
    """

    __slots__ = ("_plain",)
    if TYPE_CHECKING:
        step: int
        bodies: int
        pairs: int
        manifolds: int
        contacts: int
        vertices: int
        vertex_contacts: int
        colors: int
        clashes: int
        broken_joints: int
        sleeping_bodies: int
        stopped_bodies: int
        quarantined: int
        failed_solves: int
        restarts: int
        sorted: int
        unfinished_motion: float
        total_ms: float
    _NAMES = tuple(name for name, *_ in _abi.StepReport._fields_)

    def __init__(self) -> None:
        self._plain = _abi.StepReport()

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        return getattr(self._plain, name)

    def __dir__(self) -> list[str]:
        return list(self._NAMES)

    def __repr__(self) -> str:
        return (f"<rubble.StepReport {self.step}: {self.bodies} bodies, {self.contacts} contacts, "
                f"{self.total_ms:.3g} ms>")


class Params:
    """Parameters of a world by name: ``world.params.iterations = 4``. ``dict(world.params)`` lists them."""

    __slots__ = ("_world",)

    def __init__(self, world: "World") -> None:
        object.__setattr__(self, "_world", world)

    def _all(self) -> dict[str, Any]:
        return json_of(lib.rb_world_params, self._world._pointer)

    def keys(self) -> list[str]:
        """Names of all parameters."""
        return list(self._all())

    def __iter__(self) -> Iterator[str]:
        return iter(self._all())

    def __getitem__(self, name: str) -> Any:
        return self._all()[name]

    def __getattr__(self, name: str) -> Any:
        found = self._all()
        if name not in found:
            raise AttributeError(f"no parameter {name!r}; there are {', '.join(found)}")
        value = found[name]
        return int(value) if isinstance(value, float) and name in ("iterations", "substeps") else value

    def __setattr__(self, name: str, value: Any) -> None:
        self.set(**{name: value})

    def set(self, **values: Unpack[Parameters]) -> None:
        """Sets parameters. Raises `Error` for an unknown name or a value out of range."""
        check(lib.rb_world_set_params(self._world._pointer, encode(values)))

    def __repr__(self) -> str:
        return f"<rubble.Params {self._all()}>"


class Snapshot:
    """The complete state of a world; it stays on the device on a GPU. See `World.snapshot`."""

    __slots__ = ("_handle",)

    def __init__(self, handle: Handle) -> None:
        self._handle = handle

    def to_bytes(self) -> bytes:
        """The snapshot for a file: a save game. See `from_bytes`."""
        data, count = ctypes.c_void_p(), ctypes.c_int64()
        check(lib.rb_snapshot_bytes(self._handle.pointer, ctypes.byref(data), ctypes.byref(count)))
        return ctypes.string_at(data, count.value)

    @staticmethod
    def from_bytes(data: bytes) -> "Snapshot":
        """Reads what `to_bytes` gave. Raises `Error` unless the bytes are whole and of this version."""
        return Snapshot(Handle(lib.rb_snapshot_from_bytes, lib.rb_snapshot_destroy, data, len(data)))


class World(StateArrays, Queries, View, Filmed):
    """A running simulation of a scene.

    Args:
        scene: What to simulate.
        backend: "cpu", "cuda", "reference" (double precision) or another of ``rubble.info()["backends"]``.
        threads: 0: one per core.
        events: Collect the events of each step.
        options: "preset", "timings", "instruction_set" and parameters by name: dt [s], iterations, substeps,
            sleeping.
    Raises:
        Error: For an invalid scene or option.

    A world is used by one thread at a time. Steps release the interpreter lock.
    """

    def __init__(self, scene: Scene, *, backend: str = "cpu", threads: int = 0, events: bool = False,
                 **options: Unpack[WorldOptions]) -> None:
        given = {"backend": backend, "threads": threads, "events": events, **options}
        self._own(Handle(lib.rb_world_create, lib.rb_world_destroy, scene._pointer, encode(given)))

    def _own(self, owner: Any) -> None:
        """Takes a world that `owner` keeps alive and whose address is its pointer."""
        self._owner, self._pointer = owner, owner.pointer
        self._view = _abi.Array()
        self._view_reference = ctypes.byref(self._view)
        self._views: list[Any] = [None] * len(NAMES)
        self._epoch = -1

    # Made anew each time, because a world that kept them would be a cycle of references.
    @property
    def bodies(self) -> Bodies:
        """Bodies by name or place."""
        return Bodies(self)

    @property
    def shapes(self) -> Shapes:
        """Shapes by place."""
        return Shapes(self)

    @property
    def joints(self) -> Joints:
        """Joints by name or place."""
        return Joints(self)

    @property
    def deformables(self) -> Deformables:
        """Deformable objects by name or place."""
        return Deformables(self)

    @property
    def attachments(self) -> Attachments:
        """Attachments by place."""
        return Attachments(self)

    @property
    def params(self) -> Params:
        """Parameters by name."""
        return Params(self)

    def step(self, count: int = 1, *, progress: ProgressOption = None) -> StepReport:
        """Advances the world by `count` steps of ``params.dt``.

        Args:
            count: Number of steps.
            progress: True: a bar on a terminal, lines with the time left in a log. A function: it is called
                after each step with the steps done, all steps, and the time left [s].
        Returns:
            The report of the last step.

        Ctrl-C ends the call between two steps, and the world stays as it is then.
        """
        report = StepReport()
        reference = ctypes.byref(report._plain)
        pointer, take = self._pointer, lib.rb_world_step
        if progress:
            with Progress(progress, "world", count) as bar:
                for k in range(count):
                    check(take(pointer, reference))
                    bar.update(k + 1, report.total_ms)
            return report
        for _ in range(count):
            if take(pointer, reference):
                check(1)
        if held := self._owner.held:
            held.clear()
        return report

    def run_events(self) -> None:
        """Applies the scripted events that are due, so that changes before the next step find them done."""
        check(lib.rb_world_run_events(self._pointer))

    @property
    def report(self) -> dict[str, Any]:
        """The complete report of the last step, with "stages_ms", "grown" and "broken"."""
        return json_of(lib.rb_world_report, self._pointer)

    @property
    def gravity(self) -> np.ndarray:
        """[m/s2], shape (3,)."""
        out = (ctypes.c_double * 3)()
        check(lib.rb_world_gravity(self._pointer, out))
        return np.array(out)

    @gravity.setter
    def gravity(self, value: Vector) -> None:
        check(lib.rb_world_set_gravity(self._pointer, vector(value, "gravity")))

    def set_material_pair(self, a: str, b: str, **coefficients: Unpack[MaterialPair]) -> None:
        """Adds a rule for two named materials, or replaces theirs, as `Scene.add_material_pair`."""
        check(lib.rb_world_set_material_pair(self._pointer, encode({"a": a, "b": b, **coefficients})))

    def remove_material_pair(self, a: str, b: str) -> None:
        """Removes the rule for two named materials. Raises `Error` if there is none."""
        check(lib.rb_world_remove_material_pair(self._pointer, a.encode(), b.encode()))

    @property
    def material_pairs(self) -> list[dict[str, Any]]:
        """All rules of pairs of materials."""
        return json_of(lib.rb_world_material_pairs, self._pointer)

    @property
    def step_count(self) -> int:
        """Number of steps taken; a snapshot restores it."""
        return lib.rb_world_step_count(self._pointer)

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return lib.rb_world_time(self._pointer)

    def body_at(self, index: int) -> Body:
        """The body with that index in the scene, even if it was removed. Raises `Error` if there is none."""
        out = _abi.BodyId()
        check(lib.rb_world_body_at(self._pointer, index, ctypes.byref(out)))
        return Body(self, out)

    def deformable_at(self, index: int) -> Deformable:
        """The deformable object with that index in the scene. Raises `Error` as `body_at` does."""
        out = _abi.DeformableId()
        check(lib.rb_world_deformable_at(self._pointer, index, ctypes.byref(out)))
        return Deformable(self, out)

    def set_collide(self, a: Body, b: Body, collide: bool) -> None:
        """Enables or disables collision between two bodies."""
        check(lib.rb_world_set_collide(self._pointer, a._id, b._id, int(collide)))

    def snapshot(self) -> Snapshot:
        """The complete state. A restored world continues bit for bit."""
        return Snapshot(Handle(lib.rb_world_snapshot, lib.rb_snapshot_destroy, self._pointer))

    def restore(self, snapshot: Snapshot) -> None:
        """Returns to a snapshot, of this world or of another one: bodies, joints, contacts, time and ids are
        those of it. Array views become invalid.

        Raises:
            Error: For a snapshot of another precision: one of backend "reference" in another, or the reverse.
        """
        check(lib.rb_world_restore(self._pointer, snapshot._handle.pointer))

    def hash(self) -> int:
        """Hash of the persistent state: equal states have equal hashes."""
        out = ctypes.c_uint64()
        check(lib.rb_world_hash(self._pointer, ctypes.byref(out)))
        return out.value

    def table_hashes(self) -> dict[str, int]:
        """Hashes of the single tables of that state, by name: to find what differs between two worlds."""
        return json_of(lib.rb_world_table_hashes, self._pointer)

    def reserve(self, kind: str, count: int) -> None:
        """Reserves table memory for elements of a kind ("pairs", "manifolds"), so that steps need not
        grow it."""
        check(lib.rb_world_reserve(self._pointer, kind.encode(), count))

    @property
    def memory_bytes(self) -> int:
        """Memory of the tables of the engine [bytes]."""
        return lib.rb_world_memory_bytes(self._pointer)

    def first_difference(self) -> str:
        """Backend "lockstep" only: the first difference found, or ""."""
        return text_of(lib.rb_world_first_difference, self._pointer)

    def __repr__(self) -> str:
        parts = [f"{len(self.bodies)} bodies", f"{len(self.joints)} joints"]
        if len(self.deformables):
            parts.append(f"{len(self.deformables)} deformables")
        return f"<rubble.World {', '.join(parts)}, t = {self.time:.4g} s>"
