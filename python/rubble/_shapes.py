"""Shapes of bodies, as definitions with the keys of scene files. Lengths in [m]; the axis is local z."""
from __future__ import annotations

import ctypes
from typing import Any, NamedTuple, Sequence

import numpy as np

from . import _abi
from ._library import Handle, check, encode, lib

Definition = dict[str, Any]


def box(x: float, y: float, z: float, rounding: float = 0) -> Definition:
    """A box about the origin with these full edge lengths [m]. `rounding`: radius of its edges [m]."""
    return {"type": "box", "size": [x, y, z], **({"rounding": rounding} if rounding else {})}


def sphere(radius: float) -> Definition:
    """A sphere about the origin of the shape frame, `radius` above 0 [m]."""
    return {"type": "sphere", "radius": radius}


def capsule(radius: float, length: float) -> Definition:
    """A capsule along local z. `radius` [m]; `length`: distance of the centers of its two ends [m]."""
    return {"type": "capsule", "radius": radius, "length": length}


def plane() -> Definition:
    """A half space, solid where local z is below 0. Static bodies only."""
    return {"type": "plane"}


def cylinder(radius: float, length: float, rounding: float = 0) -> Definition:
    """A cylinder along local z about its middle, `radius` and `length` above 0 [m]. `rounding`: radius of its
    edges [m]."""
    return {"type": "cylinder", "radius": radius, "length": length,
            **({"rounding": rounding} if rounding else {})}


def cone(radius: float, length: float) -> Definition:
    """A cone along local z: base of `radius` [m] at z = -length / 2, tip at +length / 2 [m]."""
    return {"type": "cone", "radius": radius, "length": length}


def hull(points: Any, rounding: float = 0) -> Definition:
    """The convex hull of points (n, 3) in the shape frame [m]. `rounding`: radius of its edges [m]."""
    return {"type": "hull", "points": np.asarray(points, float).tolist(),
            **({"rounding": rounding} if rounding else {})}


def compound(*parts: Definition) -> Definition:
    """Convex shapes that move as one: dicts with "shape", and "position", "orientation", "material" or
    "density" where wanted."""
    return {"type": "compound", "parts": list(parts)}


def mesh(vertices: Any, triangles: Any, two_sided: bool = False) -> Definition:
    """A triangle mesh: (n, 3) vertices [m], (m, 3) indices, counter-clockwise seen from outside. Static and
    kinematic bodies only."""
    return {"type": "mesh", "vertices": np.asarray(vertices, float).tolist(),
            "triangles": np.asarray(triangles, int).tolist(), **({"two_sided": True} if two_sided else {})}


def height_field(heights: Any, spacing: Sequence[float]) -> Definition:
    """Heights [m] over local x and y, shape (count y, count x), `spacing` (dx, dy) apart. The first sample
    lies at the origin. Static and kinematic bodies only."""
    samples = np.asarray(heights, float)
    return {"type": "height_field", "counts": list(samples.shape[::-1]), "spacing": list(spacing),
            "heights": samples.ravel().tolist()}


def distance_field(distances: Any, spacing: float, origin: Sequence[float] = (0, 0, 0)) -> Definition:
    """A solid by signed distances [m], negative inside, shape (count z, count y, count x)."""
    samples = np.asarray(distances, float)
    return {"type": "distance_field", "counts": list(samples.shape[::-1]), "origin": list(origin),
            "spacing": spacing, "distances": samples.ravel().tolist()}


class Mass(NamedTuple):
    """Mass properties."""

    mass: float  #: [kg]
    inertia: np.ndarray  #: (3,) principal moments [kg m2]
    center: np.ndarray  #: (3,) center of mass in the shape frame [m]
    axes: np.ndarray  #: (4,) principal axes -> shape frame

    @classmethod
    def of(cls, mass: _abi.Mass) -> "Mass":
        """From the struct of the C library."""
        return cls(mass.mass, np.array(mass.inertia), np.array(mass.center), np.array(mass.axes))


class ShapeHandle(Handle):
    """A shape of the library, for queries."""

    __slots__ = ()

    def __init__(self, shape: Definition) -> None:
        super().__init__(lib.rb_shape_create, lib.rb_shape_destroy, encode(shape))


def mass_of(shape: Definition, density: float = 1000) -> Mass:
    """Mass properties of a shape at a density [kg/m3]: zeros for a plane, mesh or height field. Raises
    `Error` with the path of an invalid field of the shape."""
    handle, out = ShapeHandle(shape), _abi.Mass()
    check(lib.rb_shape_mass(handle.pointer, density, ctypes.byref(out)))
    return Mass.of(out)
