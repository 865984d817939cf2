"""Spatial queries and measures of a world."""
from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, Iterable, NamedTuple, Optional

import numpy as np

from . import _abi
from ._arrays import answer_of, cast_arrays
from ._bodies import Body, Vector
from ._library import check, encode, lib, list_of, matrix, structs
from ._shapes import Definition, ShapeHandle
from ._soft import Deformable

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._options import DrawOptions, FilterFields

ALL = 0xFFFFFFFF


class Hit(NamedTuple):
    """What a query found first."""

    body: Optional[Body]  #: None: a deformable object
    distance: float  #: [m]; of a shape cast the fraction of the displacement
    position: np.ndarray  #: (3,) [m]
    normal: np.ndarray  #: (3,) outward from what is hit; zeros for a closest point
    object: Optional[Deformable]  #: None: a body
    part: int  #: of a compound: index into its parts
    triangle: int  #: of a mesh, height field or deformable object: its index; otherwise -1
    user_data: int  #: of the body or object
    shape_user_data: int  #: of the shape of the body, or of the part of a compound


class RayHits(NamedTuple):
    """First hits of n rays: numpy arrays, or for rays on the device `DeviceArray` objects, which are valid
    until the next call of `cast_ray_arrays`."""

    distances: Any  #: (n, 1) [m], float32; `max_distance` without a hit
    bodies: Any  #: (n, 1) `body.index` in its world, int32; -1 without a hit
    normals: Any  #: (n, 3) outward from the body, float32; zeros without a hit


class Quality(NamedTuple):
    """Measures of the present state."""

    penetration_mean: float  #: [m]
    penetration_p99: float  #: [m]
    penetration_max: float  #: [m]
    joint_gap_mean: float  #: [m]
    joint_gap_max: float  #: [m]
    kinetic_energy: float  #: [J]
    potential_energy: float  #: relative to the origin [J]
    max_speed: float  #: [m/s]


class Events(NamedTuple):
    """Events of the last step, as structured arrays. Empty unless the world has ``events=True``."""

    #: "phase" (0 begin, 1 stay, 2 end), "a", "b", "user_data_a", "user_data_b", "shape_user_data_a",
    #: "shape_user_data_b", "sensor", "impulse" [N s], "first_point", "point_count"
    contacts: np.ndarray
    points: np.ndarray  #: contact points, as `World.contacts`
    joints: np.ndarray  #: joints that broke: "joint", "user_data", "a", "b", "force" [N], "torque" [N m]
    sleeps: np.ndarray  #: "body", "asleep", "user_data"


class DebugDraw(NamedTuple):
    """Primitives in world coordinates [m]. Colors are 0xRRGGBB."""

    lines: np.ndarray  #: structured: "from", "to", "color"
    triangles: np.ndarray  #: structured: "corners" (9 numbers), "color"; counter-clockwise from outside
    texts: list[tuple[np.ndarray, str, int]]  #: position (3,), text, color


class Queries:
    """Queries of a world. Poses are those after the last step.

    Every query takes `layers` and `mask` (bit sets), `sensors` (also test sensors), `ignore` (a body),
    `deformables` (also test deformable objects) and `ignore_object`. Hits are structured arrays: "hit",
    "body" and "object" (index -1: none), "part", "triangle", "distance" [m], "position" [m], "normal",
    "user_data", "shape_user_data". The "distance" of a shape cast is the fraction of its way.
    """

    _pointer: Any
    _owner: Any

    def _hit(self, found: Any) -> Optional[Hit]:
        if not found["hit"]:
            return None
        body, object = (None if index < 0 else (index, generation)
                        for index, generation in (found["body"].tolist(), found["object"].tolist()))
        return Hit(body and Body(self, _abi.BodyId(*body)),  # type: ignore[arg-type]
                   float(found["distance"]), found["position"].copy(), found["normal"].copy(),
                   object and Deformable(self, _abi.DeformableId(*object)),  # type: ignore[arg-type]
                   int(found["part"]), int(found["triangle"]), int(found["user_data"]),
                   int(found["shape_user_data"]))

    def cast_ray(self, origin: Vector, direction: Vector, max_distance: float = 1e6,
                 **filter: Unpack[FilterFields]) -> Optional[Hit]:
        """First hit of a ray from `origin` [m], or None."""
        return self._hit(self.cast_rays([origin], [direction], max_distance, **filter)[0])

    def cast_rays(self, origins: Any, directions: Any, max_distance: float = 1e6,
                  **filter: Unpack[FilterFields]) -> np.ndarray:
        """First hits of many rays: origins (n, 3) [m], directions (n, 3) of any length."""
        rays = _rays(origins, directions, max_distance, filter)
        hits = np.zeros(len(rays), np.dtype(_abi.Hit))
        check(lib.rb_world_cast_rays(self._pointer, rays.ctypes.data, len(rays), hits.ctypes.data))
        return hits

    def cast_ray_arrays(self, origins: Any, directions: Any, max_distance: float = 1e6,
                        **filter: Unpack[FilterFields]) -> RayHits:
        """First hits of many rays as arrays, where the rays are: depths for learners.

        Args:
            origins: (n, 3) [m].
            directions: (n, 3) of any length. Both are host arrays, or with the backend "cuda" both arrays of
                its device, as in `scatter`: nothing goes to the host then.
            filter: Without deformable objects.
        Raises:
            Error: For a ray in host memory that is not finite or has no direction. On the device its distance
                is NaN.
        """
        def call(pointer: Any, _: Any, rays: Any, hits: Any) -> int:
            return lib.rb_world_cast_ray_arrays(pointer, rays, hits)
        return RayHits(*cast_arrays(call, self._owner, {"origins": origins, "directions": directions,
                                                        "worlds": None}, max_distance, filter_of(**filter)))

    def cast_shape(self, shape: Definition, position: Vector, displacement: Vector,
                   orientation: Vector = (1, 0, 0, 0), **filter: Unpack[FilterFields]) -> Optional[Hit]:
        """First hit of a shape on a straight way [m], or None."""
        return self._hit(self.cast_shapes(shape, [position], [displacement], [orientation], **filter)[0])

    def cast_shapes(self, shape: Definition, positions: Any, displacements: Any, orientations: Any = None,
                    **filter: Unpack[FilterFields]) -> np.ndarray:
        """First hits of a shape on many ways: positions, displacements (n, 3) [m], orientations (n, 4)."""
        handle = ShapeHandle(shape)
        casts = _placed(np.dtype(_abi.Cast), handle, positions, orientations, filter)
        casts["displacement"] = matrix(displacements, "displacements", rows=len(casts))
        hits = np.zeros(len(casts), np.dtype(_abi.Hit))
        check(lib.rb_world_cast_shapes(self._pointer, casts.ctypes.data, len(casts), hits.ctypes.data))
        return hits

    def overlap(self, shape: Definition, position: Vector, orientation: Vector = (1, 0, 0, 0),
                **filter: Unpack[FilterFields]) -> list[Body]:
        """Bodies that overlap a shape at a place [m]."""
        return self.overlaps(shape, [position], [orientation], **filter)[0]

    def overlaps(self, shape: Definition, positions: Any, orientations: Any = None,
                 **filter: Unpack[FilterFields]) -> list[list[Body]]:
        """Bodies that overlap a shape at each of many places: positions (n, 3) [m], orientations (n, 4)."""
        handle = ShapeHandle(shape)
        queries = _placed(np.dtype(_abi.Overlap), handle, positions, orientations, filter)
        offsets, bodies = ctypes.c_void_p(), ctypes.c_void_p()
        check(lib.rb_world_overlaps(self._pointer, queries.ctypes.data, len(queries), ctypes.byref(offsets),
                                    ctypes.byref(bodies)))
        ends = structs(offsets.value, len(queries) + 1, ctypes.c_int64)
        ids = structs(bodies.value, int(ends[-1]), _abi.BodyId).tolist()
        found = [Body(self, _abi.BodyId(*id)) for id in ids]  # type: ignore[arg-type]
        return [found[begin:end] for begin, end in zip(ends[:-1], ends[1:])]

    def _all(self, function: Any, queries: np.ndarray) -> list[np.ndarray]:
        offsets, hits = ctypes.c_void_p(), ctypes.c_void_p()
        check(function(self._pointer, queries.ctypes.data, len(queries), ctypes.byref(offsets),
                       ctypes.byref(hits)))
        ends = structs(offsets.value, len(queries) + 1, ctypes.c_int64)
        found = structs(hits.value, int(ends[-1]), _abi.Hit)
        return [found[begin:end].copy() for begin, end in zip(ends[:-1], ends[1:])]

    def cast_rays_all(self, origins: Any, directions: Any, max_distance: float = 1e6,
                      **filter: Unpack[FilterFields]) -> list[np.ndarray]:
        """All hits of many rays, an array for each, ascending in distance: the first of each part of each
        body and of each deformable object."""
        return self._all(lib.rb_world_cast_rays_all, _rays(origins, directions, max_distance, filter))

    def cast_shapes_all(self, shape: Definition, positions: Any, displacements: Any, orientations: Any = None,
                        **filter: Unpack[FilterFields]) -> list[np.ndarray]:
        """All hits of a shape on many ways, as `cast_rays_all`."""
        handle = ShapeHandle(shape)
        casts = _placed(np.dtype(_abi.Cast), handle, positions, orientations, filter)
        casts["displacement"] = matrix(displacements, "displacements", rows=len(casts))
        return self._all(lib.rb_world_cast_shapes_all, casts)

    def overlaps_all(self, shape: Definition, positions: Any, orientations: Any = None,
                     **filter: Unpack[FilterFields]) -> list[np.ndarray]:
        """What overlaps a shape at each of many places, as `cast_rays_all` without positions and normals."""
        handle = ShapeHandle(shape)
        queries = _placed(np.dtype(_abi.Overlap), handle, positions, orientations, filter)
        return self._all(lib.rb_world_overlaps_all, queries)

    def closest_point(self, point: Vector, max_distance: float = 1e3,
                      **filter: Unpack[FilterFields]) -> Optional[Hit]:
        """Closest point of anything to a point [m], or None."""
        return self._hit(self.closest_points([point], max_distance, **filter)[0])

    def closest_points(self, points: Any, max_distance: float = 1e3,
                       **filter: Unpack[FilterFields]) -> np.ndarray:
        """Closest points to points (n, 3) [m]."""
        given = matrix(points, "points")
        queries = np.zeros(len(given), np.dtype(_abi.Closest))
        queries["point"], queries["max_distance"] = given, max_distance
        _set_filter(queries, **filter)
        hits = np.zeros(len(given), np.dtype(_abi.Hit))
        check(lib.rb_world_closest_points(self._pointer, queries.ctypes.data, len(queries), hits.ctypes.data))
        return hits

    @property
    def contacts(self) -> np.ndarray:
        """Contact points of the last step, structured: "a", "b", "position" [m], "normal" from A to B,
        "depth" [m], "force" on B [N], "part_a", "part_b"."""
        return list_of(lib.rb_world_contacts, _abi.ContactPoint, self._pointer)

    def contact_forces(self, pairs: Iterable[tuple[Body, Body]]) -> Any:
        """Contact forces of the last step between the two bodies of each pair, on the second one, world axes
        [N]: (n, 3), a copy, or a `DeviceArray` with the backend "cuda"."""
        ids = np.array([body.id for pair in pairs for body in pair], np.dtype(_abi.BodyId))
        forces = _abi.Array()
        check(lib.rb_world_contact_forces(self._pointer, ids.ctypes.data, len(ids) // 2,
                                          ctypes.byref(forces)))
        return answer_of(forces, self._owner)

    def debug_draw(self, **options: Unpack[DrawOptions]) -> DebugDraw:
        """The world as colored primitives, for a renderer of the caller.

        Args:
            options: surfaces (True), edges, contacts, joints, bounds, names (False), force_scale [m/N],
                plane_size [m], segments.
        """
        out = _abi.DebugDraw()
        check(lib.rb_world_debug_draw(self._pointer, encode(options), ctypes.byref(out)))
        texts = ctypes.cast(out.texts, ctypes.POINTER(_abi.DebugText))
        return DebugDraw(structs(out.lines, out.line_count, _abi.DebugLine),
                         structs(out.triangles, out.triangle_count, _abi.DebugTriangle),
                         [(np.array(texts[k].position), texts[k].text.decode(), texts[k].color)
                          for k in range(out.text_count)])

    @property
    def vertex_contacts(self) -> np.ndarray:
        """Contacts of vertices, structured: "object", "vertex", "body", "other_object", "other_vertex",
        "normal", "depth" [m], "force" [N]."""
        return list_of(lib.rb_world_vertex_contacts, _abi.VertexContact, self._pointer)

    @property
    def solver_states(self) -> np.ndarray:
        """Structured array in the order of ``bodies``: "color", "stiffness" [N/m], "multiplier" [N]."""
        return list_of(lib.rb_world_solver_states, _abi.SolverState, self._pointer)

    @property
    def quality(self) -> Quality:
        """Penetrations [m], joint gaps [m], energies [J] and speed [m/s] of the present state; see
        `Quality`."""
        out = _abi.Quality()
        check(lib.rb_world_quality(self._pointer, ctypes.byref(out)))
        depth = out.penetration
        return Quality(depth.mean, depth.p99, depth.max, out.joint_gap_mean, out.joint_gap_max,
                       out.kinetic_energy, out.potential_energy, out.max_speed)

    @property
    def events(self) -> Events:
        """Events of the last step; see `Events`."""
        out = _abi.Events()
        check(lib.rb_world_events(self._pointer, ctypes.byref(out)))
        return Events(structs(out.contacts, out.contact_count, _abi.ContactEvent),
                      structs(out.points, out.point_count, _abi.ContactPoint),
                      structs(out.joints, out.joint_count, _abi.JointEvent),
                      structs(out.sleeps, out.sleep_count, _abi.SleepEvent))


def _set_filter(queries: np.ndarray, layers: int = ALL, mask: int = ALL, sensors: bool = False,
                ignore: Optional[Body] = None, deformables: bool = False,
                ignore_object: Optional[Deformable] = None) -> None:
    chosen = queries["filter"]
    chosen["layers"], chosen["mask"], chosen["sensors"] = layers, mask, sensors
    chosen["deformables"] = deformables
    for key, skipped in (("ignore", ignore), ("ignore_object", ignore_object)):
        chosen[key]["index"], chosen[key]["generation"] = (-1, 0) if skipped is None else skipped.id


def filter_of(**filter: Unpack[FilterFields]) -> _abi.QueryFilter:
    """A filter of the library."""
    queries = np.zeros(1, np.dtype(_abi.Ray))
    _set_filter(queries, **filter)
    return _abi.Ray.from_buffer_copy(queries.tobytes()).filter


def _rays(origins: Any, directions: Any, max_distance: float, filter: FilterFields) -> np.ndarray:
    """Rays of the library: origins (n, 3) [m], directions (n, 3)."""
    start = matrix(origins, "origins")
    rays = np.zeros(len(start), np.dtype(_abi.Ray))
    rays["origin"], rays["max_distance"] = start, max_distance
    rays["direction"] = matrix(directions, "directions", rows=len(start))
    _set_filter(rays, **filter)
    return rays


def _placed(kind: np.dtype, handle: ShapeHandle, positions: Any, orientations: Any,
            filter: FilterFields) -> np.ndarray:
    """Queries of one shape at many places."""
    places = matrix(positions, "positions")
    queries = np.zeros(len(places), kind)
    queries["shape"], queries["position"] = handle.pointer.value, places
    queries["orientation"] = ((1, 0, 0, 0) if orientations is None
                              else matrix(orientations, "orientations", 4, len(places)))
    _set_filter(queries, **filter)
    return queries
