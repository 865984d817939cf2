"""Deformable objects and attachments."""
from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, NamedTuple, Optional, Sequence

import numpy as np

from . import _abi
from ._bodies import Body, Collection, Element, NamedElement, Vector, id_of
from ._joints import JointState
from ._library import check, encode, json_of, lib, list_of, matrix, vector

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._fields import AttachmentFields, DeformableFields
    from ._world import World

Definition = dict[str, Any]
_NO_OBJECT = _abi.DeformableId(-1, 0)


class Surface(NamedTuple):
    """Geometry of a deformable object for rendering."""

    vertices: np.ndarray  #: (n, 3) [m]
    triangles: np.ndarray  #: (m, 3) indices, without torn ones
    segments: np.ndarray  #: (k, 2) indices of ropes and nets, without broken ones
    radius: float  #: of the spheres or the line [m]
    spheres: bool  #: each vertex is rendered as a sphere


class Deformable(NamedElement):
    """A deformable object of a running world: solid, cloth, cable, net or particles."""

    __slots__ = ()
    _kind = "deformable"

    def _numbers(self, function: Any, columns: int) -> np.ndarray:
        count = len(self)
        out = np.empty((count, columns) if columns > 1 else count)
        check(function(self._world._pointer, self._id, out.ctypes.data, count))
        return out

    def set(self, **values: Unpack[DeformableFields]) -> None:
        """Replaces fields of the definition from the next step on, with the keys of scene files:
        ``set(youngs_modulus=2e5)``. Vertices keep position, velocity and contacts, elements their state.
        """
        check(lib.rb_world_set_deformable(self._world._pointer, self._id, encode(values)))

    def __len__(self) -> int:
        """Number of vertices."""
        out = ctypes.c_int64()
        check(lib.rb_world_vertex_count(self._world._pointer, self._id, ctypes.byref(out)))
        return out.value

    @property
    def first_vertex(self) -> int:
        """Row of its first vertex in `World.vertex_array`."""
        out = ctypes.c_int32()
        check(lib.rb_world_first_vertex(self._world._pointer, self._id, ctypes.byref(out)))
        return out.value

    @property
    def positions(self) -> np.ndarray:
        """Of its vertices, world [m]: (n, 3), a copy."""
        return self._numbers(lib.rb_world_vertex_positions, 3)

    @property
    def velocities(self) -> np.ndarray:
        """Of its vertices [m/s]: (n, 3), a copy."""
        return self._numbers(lib.rb_world_vertex_velocities, 3)

    @property
    def masses(self) -> np.ndarray:
        """Of its vertices [kg]: (n,); 0: fixed."""
        return self._numbers(lib.rb_world_vertex_masses, 1)

    def set_vertices(self, positions: Any, velocities: Any = None) -> None:
        """Sets positions (n, 3) [m] and velocities (n, 3) [m/s] of all vertices; None: 0."""
        count = len(self)
        x = matrix(positions, "positions", rows=count)
        v = np.zeros_like(x) if velocities is None else matrix(velocities, "velocities", rows=count)
        check(lib.rb_world_set_vertices(self._world._pointer, self._id, x.ctypes.data, v.ctypes.data, count))

    def apply_force(self, vertex: int, force: Vector) -> None:
        """Applies a force [N] to a vertex for the next step."""
        check(lib.rb_world_apply_vertex_force(self._world._pointer, self._id, vertex, vector(force, "force")))

    @property
    def surface(self) -> Surface:
        """Vertices (n, 3) [m], triangles (m, 3) and segments (k, 2) to draw it by, copies; see `Surface`.
        Raises `Error` once the object is removed."""
        out = _abi.Surface()
        check(lib.rb_world_surface(self._world._pointer, self._id, ctypes.byref(out)))

        def array(address: Optional[int], count: int, columns: int, kind: Any) -> np.ndarray:
            size = count * columns * np.dtype(kind).itemsize
            raw = ctypes.string_at(address, size) if address and size else b""
            return np.frombuffer(raw, kind).reshape(count, columns)

        return Surface(array(out.vertices, out.vertex_count, 3, np.float64),
                       array(out.triangles, out.triangle_count, 3, np.int32),
                       array(out.segments, out.segment_count, 2, np.int32), out.radius, bool(out.spheres))

    @property
    def solver_states(self) -> np.ndarray:
        """Structured array: "color", "stiffness" [N/m], "multiplier" [N] of each vertex."""
        function = lib.rb_world_vertex_solver_states
        return list_of(function, _abi.SolverState, self._world._pointer, self._id)

    def __repr__(self) -> str:
        if not self.alive:
            return f"<rubble.Deformable {self.index} removed>"
        return f"<rubble.Deformable {self.name or self.index!r} with {len(self)} vertices>"


class Deformables(Collection):
    """The deformable objects of a world."""

    _list, _find = "rb_world_deformables", "rb_world_find_deformable"
    _id_type, _type = _abi.DeformableId, Deformable

    def add(self, definition: Optional[Definition] = None,
            **fields: Unpack[DeformableFields]) -> Deformable:
        """Adds an object with the keys of scene files, or a definition that `tet_box` and others make, with
        `fields` in addition. Raises `Error` with the path of an invalid field."""
        out = _abi.DeformableId()
        check(lib.rb_world_add_deformable(self._world._pointer, encode({**(definition or {}), **fields}),
                                          ctypes.byref(out)))
        return Deformable(self._world, out)


class Attachment(Element):
    """A constraint between vertices and a body, the world, or other vertices."""

    __slots__ = ()
    _kind = "attachment"

    @property
    def state(self) -> JointState:
        """Gap [m] and force (3,) [N] on the vertices after the last step; angle, torque and axes are 0 and
        empty. Raises `Error` once the attachment is removed."""
        out = _abi.JointState()
        check(lib.rb_world_attachment_state(self._world._pointer, self._id, ctypes.byref(out)))
        return JointState.of(out)

    @property
    def ends(self) -> tuple[Deformable, Optional[Deformable], Optional[Body], np.ndarray]:
        """Object, other object, body (None: the world) and anchor (3,) [m]."""
        out = _abi.AttachmentEnds()
        check(lib.rb_world_attachment_ends(self._world._pointer, self._id, ctypes.byref(out)))
        copy = [type(id)(id.index, id.generation) for id in (out.object, out.other_object, out.body)]
        return (Deformable(self._world, copy[0]),
                Deformable(self._world, copy[1]) if copy[1].index >= 0 else None,
                Body(self._world, copy[2]) if copy[2].index >= 0 else None, np.array(out.anchor))

    def __repr__(self) -> str:
        return f"<rubble.Attachment {self.index}{'' if self.alive else ' removed'}>"


class Attachments(Collection):
    """The attachments of a world, by index; they have no names."""

    _list, _find = "rb_world_attachments", ""
    _id_type, _type = _abi.AttachmentId, Attachment

    def __getitem__(self, key: Any) -> Attachment:
        return self._make(*self.ids[key].tolist())

    def add(self, object: Deformable, vertices: Sequence[int], body: Optional[Body] = None, *,
            other: Optional[Deformable] = None, **fields: Unpack[AttachmentFields]) -> Attachment:
        """Attaches the mean of up to four vertices to a body (None: the world) or to `other_vertices` of
        another object. `fields`: keys of scene files, such as ``stiffness`` [N/m] and ``anchor`` [m].
        Raises `Error` for vertices that the object does not have, or with the path of an invalid field."""
        out = _abi.AttachmentId()
        definition = encode({"vertices": list(vertices), **fields})
        check(lib.rb_world_add_attachment(self._world._pointer, definition, object._id, id_of(body),
                                          _NO_OBJECT if other is None else other._id, ctypes.byref(out)))
        return Attachment(self._world, out)


def tet_box(corner: Vector, size: Vector, cells: Sequence[int]) -> Definition:
    """A box of tetrahedra: lowest corner [m], size [m] and cells along x, y, z. A definition for
    ``deformables.add`` and ``Scene.add_deformable``, with further keys: ``youngs_modulus=1e5``."""
    grid = (ctypes.c_int32 * 3)(*cells)
    return json_of(lib.rb_tet_box, vector(corner, "corner"), vector(size, "size"), grid)


def tet_ball(center: Vector, radius: float, cells: int) -> Definition:
    """A ball of tetrahedra, with `cells` (at least 2) along an edge of the cube that it is mapped from."""
    return json_of(lib.rb_tet_ball, vector(center, "center"), radius, cells)


def tet_solid(vertices: Any, triangles: Any, cell: float) -> Definition:
    """Tetrahedra of width `cell` [m] inside a closed surface: (n, 3) vertices, (m, 3) triangles."""
    x, t = matrix(vertices, "vertices"), np.ascontiguousarray(triangles, np.int32)
    return json_of(lib.rb_tet_solid, x.ctypes.data, len(x), t.ctypes.data, len(t), cell)


def cloth_sheet(corner: Vector, u: Vector, v: Vector, cells_u: int, cells_v: int) -> Definition:
    """Cloth of cells with two triangles each: corner + s u + t v [m]."""
    place = (vector(corner, "corner"), vector(u, "u"), vector(v, "v"))
    return json_of(lib.rb_cloth_sheet, *place, cells_u, cells_v)


def straight_cable(start: Vector, end: Vector, segments: int) -> Definition:
    """A straight cable [m]."""
    return json_of(lib.rb_straight_cable, vector(start, "start"), vector(end, "end"), segments)


def cable_along(points: Any, segment: float, closed: bool = False) -> Definition:
    """A cable along points (n, 3) [m], in segments of about that length [m]."""
    x = matrix(points, "points")
    return json_of(lib.rb_cable_along, x.ctypes.data, len(x), segment, int(closed))
