"""Spatial queries and measures of a world."""
from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, NamedTuple, Optional

import numpy as np

from . import _abi
from ._bodies import WORLD, Body, Vector
from ._library import check, lib, list_of, matrix, structs
from ._shapes import Definition, ShapeHandle

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._fields import FilterFields

ALL = 0xFFFFFFFF


class Hit(NamedTuple):
    """What a query found first."""

    body: Body
    distance: float  #: [m]; of a shape cast the fraction of the displacement
    position: np.ndarray  #: (3,) [m]
    normal: Optional[np.ndarray]  #: (3,) outward from the body; None for a closest point


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

    contacts: np.ndarray  #: "phase" (0 begin, 1 stay, 2 end), "a", "b", "sensor", "impulse" [N s], points
    points: np.ndarray  #: contact points: "position" [m], "normal", "depth" [m], "force" [N]
    joints: np.ndarray  #: joints that broke: "joint", "a", "b", "force" [N], "torque" [N m]
    sleeps: np.ndarray  #: "body", "asleep"


class Queries:
    """Queries of a world. Poses are those after the last step.

    Every query takes `layers` and `mask` (bit sets), `sensors` (also test sensors) and `ignore` (a body).
    """

    _pointer: Any

    def _hit(self, found: Any, measure: str) -> Optional[Hit]:
        if not found["hit"]:
            return None
        index, generation = found["body"].tolist()
        normal = found["normal"].copy() if "normal" in found.dtype.names else None
        body = Body(self, _abi.BodyId(index, generation))  # type: ignore[arg-type]
        return Hit(body, float(found[measure]), found["position"].copy(), normal)

    def cast_ray(self, origin: Vector, direction: Vector, max_distance: float = 1e6,
                 **filter: Unpack[FilterFields]) -> Optional[Hit]:
        """First body on a ray from `origin` [m], or None."""
        return self._hit(self.cast_rays([origin], [direction], max_distance, **filter)[0], "distance")

    def cast_rays(self, origins: Any, directions: Any, max_distance: float = 1e6,
                  **filter: Unpack[FilterFields]) -> np.ndarray:
        """First hits of many rays: origins (n, 3) [m], directions (n, 3) of any length.

        Returns:
            Structured array (n,): "hit", "body", "distance" [m], "position" [m], "normal".
        """
        start = matrix(origins, "origins")
        along = matrix(directions, "directions", rows=len(start))
        rays, hits = np.zeros(len(start), np.dtype(_abi.Ray)), np.zeros(len(start), np.dtype(_abi.RayHit))
        rays["origin"], rays["direction"], rays["max_distance"] = start, along, max_distance
        _set_filter(rays, **filter)
        check(lib.rb_world_cast_rays(self._pointer, rays.ctypes.data, len(rays), hits.ctypes.data))
        return hits

    def cast_shape(self, shape: Definition, position: Vector, displacement: Vector,
                   orientation: Vector = (1, 0, 0, 0), **filter: Unpack[FilterFields]) -> Optional[Hit]:
        """First body that a shape meets on a straight way [m], or None."""
        return self._hit(self.cast_shapes(shape, [position], [displacement], [orientation], **filter)[0],
                         "fraction")

    def cast_shapes(self, shape: Definition, positions: Any, displacements: Any, orientations: Any = None,
                    **filter: Unpack[FilterFields]) -> np.ndarray:
        """First hits of a shape on many ways: positions, displacements (n, 3) [m], orientations (n, 4).

        Returns:
            Structured array (n,): "hit", "body", "fraction", "position" [m], "normal".
        """
        handle = ShapeHandle(shape)
        casts = _placed(np.dtype(_abi.Cast), handle, positions, orientations, filter)
        casts["displacement"] = matrix(displacements, "displacements", rows=len(casts))
        hits = np.zeros(len(casts), np.dtype(_abi.CastHit))
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

    def _all(self, function: Any, queries: np.ndarray, deformables: bool) -> list[np.ndarray]:
        offsets, hits = ctypes.c_void_p(), ctypes.c_void_p()
        check(function(self._pointer, queries.ctypes.data, len(queries), int(deformables),
                       ctypes.byref(offsets), ctypes.byref(hits)))
        ends = structs(offsets.value, len(queries) + 1, ctypes.c_int64)
        found = structs(hits.value, int(ends[-1]), _abi.Hit)
        return [found[begin:end].copy() for begin, end in zip(ends[:-1], ends[1:])]

    def cast_rays_all(self, origins: Any, directions: Any, max_distance: float = 1e6, *,
                      deformables: bool = False, **filter: Unpack[FilterFields]) -> list[np.ndarray]:
        """All hits of many rays, ascending in distance: the first of each part of each body and, with
        `deformables`, of each deformable object.

        Returns:
            A structured array for each ray: "body", "object" (index -1: none), "part", "triangle",
            "distance" [m], "position" [m], "normal", "user_data".
        """
        start = matrix(origins, "origins")
        rays = np.zeros(len(start), np.dtype(_abi.Ray))
        rays["origin"], rays["max_distance"] = start, max_distance
        rays["direction"] = matrix(directions, "directions", rows=len(start))
        _set_filter(rays, **filter)
        return self._all(lib.rb_world_cast_rays_all, rays, deformables)

    def cast_shapes_all(self, shape: Definition, positions: Any, displacements: Any, orientations: Any = None,
                        *, deformables: bool = False, **filter: Unpack[FilterFields]) -> list[np.ndarray]:
        """All hits of a shape on many ways, as `cast_rays_all`; "distance" is the fraction of the way."""
        handle = ShapeHandle(shape)
        casts = _placed(np.dtype(_abi.Cast), handle, positions, orientations, filter)
        casts["displacement"] = matrix(displacements, "displacements", rows=len(casts))
        return self._all(lib.rb_world_cast_shapes_all, casts, deformables)

    def overlaps_all(self, shape: Definition, positions: Any, orientations: Any = None, *,
                     deformables: bool = False, **filter: Unpack[FilterFields]) -> list[np.ndarray]:
        """What overlaps a shape at each of many places, as `cast_rays_all` without positions and normals."""
        handle = ShapeHandle(shape)
        queries = _placed(np.dtype(_abi.Overlap), handle, positions, orientations, filter)
        return self._all(lib.rb_world_overlaps_all, queries, deformables)

    def closest_point(self, point: Vector, max_distance: float = 1e3,
                      **filter: Unpack[FilterFields]) -> Optional[Hit]:
        """Closest point of any body to a point [m], or None."""
        return self._hit(self.closest_points([point], max_distance, **filter)[0], "distance")

    def closest_points(self, points: Any, max_distance: float = 1e3,
                       **filter: Unpack[FilterFields]) -> np.ndarray:
        """Closest points of bodies to points (n, 3) [m].

        Returns:
            Structured array (n,): "hit", "body", "distance" [m], "position" [m].
        """
        given = matrix(points, "points")
        queries = np.zeros(len(given), np.dtype(_abi.Closest))
        queries["point"], queries["max_distance"] = given, max_distance
        _set_filter(queries, **filter)
        hits = np.zeros(len(given), np.dtype(_abi.ClosestHit))
        check(lib.rb_world_closest_points(self._pointer, queries.ctypes.data, len(queries), hits.ctypes.data))
        return hits

    @property
    def contacts(self) -> np.ndarray:
        """Contact points of the last step, structured: "a", "b", "position" [m], "normal" from A to B,
        "depth" [m], "force" on B [N]."""
        return list_of(lib.rb_world_contacts, _abi.ContactPoint, self._pointer)

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
                ignore: Optional[Body] = None) -> None:
    chosen = queries["filter"]
    chosen["layers"], chosen["mask"], chosen["sensors"] = layers, mask, sensors
    skipped = WORLD if ignore is None else ignore._id
    chosen["ignore"]["index"], chosen["ignore"]["generation"] = skipped.index, skipped.generation


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
