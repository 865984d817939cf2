"""Bodies of a running world."""
from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, Iterable, Iterator, NamedTuple, Optional, Sequence, Union

import numpy as np

from . import _abi
from ._library import Error, check, encode, json_of, lib, list_of, matrix, text_of, vector
from ._shapes import Definition, Mass, ShapeHandle

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._fields import BodyFields
    from ._world import World

Vector = Union[Sequence[float], np.ndarray]


class ContactLoad(NamedTuple):
    """Sum of all contacts of the last step on a body."""

    force: np.ndarray  #: (3,) [N]
    torque: np.ndarray  #: (3,) about the center of mass [N m]
    residual: float  #: largest remaining penetration [m]
    points: int  #: number of contact points


class Element:
    """A body, joint or other object of a world: a stable id that goes stale when the object is removed."""

    __slots__ = ("_world", "_id")
    _kind: str  #: in the names of the functions of the C library

    def __init__(self, world: "World", id: Any) -> None:
        self._world, self._id = world, id

    @property
    def index(self) -> int:
        """Slot of the object; of a body also its row in the arrays of the world."""
        return self._id.index

    @property
    def id(self) -> tuple[int, int]:
        """Slot and generation."""
        return (self._id.index, self._id.generation)

    def _function(self, pattern: str) -> Any:
        return getattr(lib, pattern.format(self._kind))

    @property
    def alive(self) -> bool:
        """Whether the object is still in the world. All else of a removed object raises `Error`."""
        return bool(self._function("rb_world_{}_alive")(self._world._pointer, self._id))

    def remove(self) -> None:
        """Removes the object and what depends on it: joints of a body, attachments of a deformable object."""
        check(self._function("rb_world_remove_{}")(self._world._pointer, self._id))

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and other._world is self._world and other.id == self.id

    def __hash__(self) -> int:
        return hash((type(self), self.id))


class Shape(Element):
    """A shape of a running world. It lives while a body has it, or until `remove` takes back its addition."""

    __slots__ = ()
    _kind = "shape"

    @property
    def definition(self) -> Definition:
        """As in a scene file."""
        return json_of(lib.rb_world_shape_definition, self._world._pointer, self._id)

    @property
    def user_data(self) -> int:
        """64 bits of the caller: "user_data" of its definition."""
        return self.definition.get("user_data", 0)

    @property
    def uses(self) -> int:
        """Number of bodies that have it, and of additions that are not taken back."""
        out = ctypes.c_int64()
        check(lib.rb_world_shape_uses(self._world._pointer, self._id, ctypes.byref(out)))
        return out.value

    def __repr__(self) -> str:
        state = self.definition["type"] if self.alive else "removed"
        return f"<rubble.Shape {self.index} {state}>"


class NamedElement(Element):
    """An element that has a name and a definition."""

    __slots__ = ()

    @property
    def name(self) -> str:
        """Its name, or "" without one. Raises `Error` once it is removed."""
        return text_of(self._function("rb_world_{}_name"), self._world._pointer, self._id)

    @property
    def definition(self) -> dict[str, Any]:
        """As in a scene file; bodies of a joint are those of `bodies`."""
        return json_of(self._function("rb_world_{}_definition"), self._world._pointer, self._id)

    @property
    def user_data(self) -> int:
        """64 bits of the caller, which events and hits carry. Assign to change them."""
        out = ctypes.c_uint64()
        check(self._function("rb_world_{}_user_data")(self._world._pointer, self._id, ctypes.byref(out)))
        return out.value

    @user_data.setter
    def user_data(self, value: int) -> None:
        check(self._function("rb_world_set_{}_user_data")(self._world._pointer, self._id, value))


class Body(NamedElement):
    """A body of a running world. Reading and writing throws `Error` once it is removed."""

    __slots__ = ()
    _kind = "body"

    def _read(self) -> _abi.BodyState:
        out = _abi.BodyState()
        check(lib.rb_world_body_state(self._world._pointer, self._id, ctypes.byref(out)))
        return out

    def _write(self, field: str, value: Vector, count: int = 3) -> None:
        state = self._read()
        setattr(state, field, vector(value, f"body.{field}", count))
        check(lib.rb_world_set_body_state(self._world._pointer, self._id, ctypes.byref(state)))

    @property
    def position(self) -> np.ndarray:
        """Of the shape frame, world [m], shape (3,). Assign to move the body."""
        return np.array(self._read().position)

    @position.setter
    def position(self, value: Vector) -> None:
        self._write("position", value)

    @property
    def orientation(self) -> np.ndarray:
        """Body -> world, a unit quaternion with the scalar first, shape (4,)."""
        return np.array(self._read().orientation)

    @orientation.setter
    def orientation(self, value: Vector) -> None:
        self._write("orientation", value, 4)

    @property
    def velocity(self) -> np.ndarray:
        """Of the center of mass [m/s], shape (3,)."""
        return np.array(self._read().velocity)

    @velocity.setter
    def velocity(self, value: Vector) -> None:
        self._write("velocity", value)

    @property
    def angular_velocity(self) -> np.ndarray:
        """World axes [rad/s], shape (3,)."""
        return np.array(self._read().angular_velocity)

    @angular_velocity.setter
    def angular_velocity(self, value: Vector) -> None:
        self._write("angular_velocity", value)

    def set_velocity(self, velocity: Vector, angular_velocity: Vector = (0, 0, 0)) -> None:
        """Velocity of the center of mass [m/s] and angular velocity about it, world axes [rad/s]."""
        check(lib.rb_world_set_velocity(self._world._pointer, self._id, vector(velocity, "velocity"),
                                        vector(angular_velocity, "angular_velocity")))

    def set(self, **values: Unpack[BodyFields]) -> None:
        """Replaces fields of the definition from the next step on, with the keys of scene files:
        ``set(mass=5)``.

        Pose and velocities are kept, and so are contacts unless the shape changes. ``mass`` and ``density``
        replace each other. ``shape`` may be a `Shape` of the world.

        Raises:
            Error: For an unknown key, an invalid value, or a body that was removed. Nothing is changed then.
        """
        fields: dict[str, Any] = dict(values)
        if isinstance(fields.get("shape"), Shape):
            check(lib.rb_world_set_shape(self._world._pointer, self._id, fields.pop("shape")._id))
        check(lib.rb_world_set_body(self._world._pointer, self._id, encode(fields)))

    @property
    def shape(self) -> Shape:
        """Its shape, which other bodies may share."""
        out = _abi.ShapeId()
        check(lib.rb_world_shape_of(self._world._pointer, self._id, ctypes.byref(out)))
        return Shape(self._world, out)

    def shape_user_data(self, part: int = 0) -> int:
        """"user_data" of a part of a compound, or of its shape."""
        out = ctypes.c_uint64()
        check(lib.rb_world_shape_user_data(self._world._pointer, self._id, part, ctypes.byref(out)))
        return out.value

    def material(self, part: int = 0) -> dict[str, Any]:
        """Material of a part of a compound, or of the whole body, as in a scene file. Values that are missing
        have their defaults."""
        return json_of(lib.rb_world_material_of, self._world._pointer, self._id, part)

    @property
    def joints(self) -> list[Any]:
        """The joints of the body, and those it is the frame body of: `Joint` objects."""
        from ._joints import Joint
        ids = list_of(lib.rb_world_joints_of, _abi.JointId, self._world._pointer, self._id).tolist()
        return [Joint(self._world, _abi.JointId(*id)) for id in ids]

    @property
    def contacts(self) -> np.ndarray:
        """Contact points of the body in the last step, as `World.contacts`."""
        return list_of(lib.rb_world_contacts_of, _abi.ContactPoint, self._world._pointer, self._id)

    def set_target(self, position: Vector, orientation: Vector = (1, 0, 0, 0)) -> None:
        """Kinematic bodies: the pose to reach in the next step."""
        check(lib.rb_world_set_target(self._world._pointer, self._id, vector(position, "position"),
                                      vector(orientation, "orientation", 4)))

    def apply_force(self, force: Vector, at: Optional[Vector] = None) -> None:
        """Applies a force [N] for the next step, at the center of mass or at a world point [m]."""
        pointer, pushed = self._world._pointer, vector(force, "force")
        if at is None:
            check(lib.rb_world_apply_force(pointer, self._id, pushed))
        else:
            check(lib.rb_world_apply_force_at(pointer, self._id, pushed, vector(at, "at")))

    def apply_torque(self, torque: Vector) -> None:
        """Applies a torque [N m] for the next step."""
        check(lib.rb_world_apply_torque(self._world._pointer, self._id, vector(torque, "torque")))

    def apply_impulse(self, impulse: Vector, at: Optional[Vector] = None) -> None:
        """Applies an impulse [N s] at the center of mass, or at a world point [m]."""
        pointer, pushed = self._world._pointer, vector(impulse, "impulse")
        if at is None:
            check(lib.rb_world_apply_impulse(pointer, self._id, pushed))
        else:
            check(lib.rb_world_apply_impulse_at(pointer, self._id, pushed, vector(at, "at")))

    def apply_angular_impulse(self, impulse: Vector) -> None:
        """Applies an angular impulse, world axes [N m s]."""
        check(lib.rb_world_apply_angular_impulse(self._world._pointer, self._id, vector(impulse, "impulse")))

    def drag(self, point: Vector, max_force: float, frequency: float = 5) -> Any:
        """Drags the body by a world point [m] with a mouse joint of at most `max_force` [N]. The result has
        `drag_to` and `remove`."""
        from ._joints import Joint
        out = _abi.JointId()
        check(lib.rb_world_add_drag_joint(self._world._pointer, self._id, vector(point, "point"), max_force,
                                          frequency, ctypes.byref(out)))
        return Joint(self._world, out)

    @property
    def mass_properties(self) -> Mass:
        """Mass [kg], principal moments [kg m2], center of mass [m] and principal axes in the shape frame."""
        out = _abi.Mass()
        check(lib.rb_world_body_mass(self._world._pointer, self._id, ctypes.byref(out)))
        return Mass.of(out)

    @property
    def mass(self) -> float:
        """[kg]; 0 for a body that is not dynamic."""
        return self.mass_properties.mass

    @property
    def contact_load(self) -> ContactLoad:
        """Sum of the contacts of the last step."""
        out = _abi.ContactLoad()
        check(lib.rb_world_contact_load(self._world._pointer, self._id, ctypes.byref(out)))
        return ContactLoad(np.array(out.force), np.array(out.torque), out.residual, out.points)

    @property
    def asleep(self) -> bool:
        """Whether the body sleeps: it is left out of the steps until it is touched or changed. Only with the
        parameter ``sleeping``."""
        out = ctypes.c_int32()
        check(lib.rb_world_asleep(self._world._pointer, self._id, ctypes.byref(out)))
        return bool(out.value)

    def wake(self) -> None:
        """Wakes the body and the island that it sleeps in. Does nothing if it is awake."""
        check(lib.rb_world_wake(self._world._pointer, self._id))

    def remove(self) -> None:
        """Removes the body and its joints."""
        check(lib.rb_world_remove_bodies(self._world._pointer, ctypes.byref(self._id), 1))

    def __repr__(self) -> str:
        if not self.alive:
            return f"<rubble.Body {self.index} removed>"
        x, y, z = self._read().position
        return f"<rubble.Body {self.name or self.index!r} at ({x:.4g}, {y:.4g}, {z:.4g})>"


WORLD = _abi.BodyId(-1, 0)  #: in place of a body: the static world


def id_of(body: Optional[Body]) -> _abi.BodyId:
    return WORLD if body is None else body._id


def ids_of(bodies: Iterable[Body]) -> np.ndarray:
    """Ids of bodies as an array of structs."""
    return np.array([body.id for body in bodies], np.dtype(_abi.BodyId))


class Collection:
    """The objects of one kind of a world that are alive, by index; ``[name]`` finds one by name."""

    _list: str
    _find: str
    _id_type: Any
    _type: Any

    def __init__(self, world: "World") -> None:
        self._world = world

    @property
    def ids(self) -> np.ndarray:
        """Structured array with the fields "index" and "generation"."""
        return list_of(getattr(lib, self._list), self._id_type, self._world._pointer)

    def _make(self, index: int, generation: int) -> Any:
        return self._type(self._world, self._id_type(index, generation))

    def __len__(self) -> int:
        return len(self.ids)

    def __iter__(self) -> Iterator[Any]:
        for index, generation in self.ids.tolist():
            yield self._make(index, generation)

    def __getitem__(self, key: Union[str, int]) -> Any:
        if isinstance(key, str):
            out = self._id_type()
            check(getattr(lib, self._find)(self._world._pointer, key.encode(), ctypes.byref(out)))
            return self._type(self._world, out)
        return self._make(*self.ids[key].tolist())

    def __contains__(self, key: object) -> bool:
        if isinstance(key, str):
            try:
                self[key]
            except Error:
                return False
            return True
        return isinstance(key, self._type) and key._world is self._world and key.alive

    def __repr__(self) -> str:
        return f"<rubble.{type(self).__name__} {len(self)}>"


class Bodies(Collection):
    """The bodies of a world: ``world.bodies["crate"]``, ``world.bodies[0]``, ``len``, iteration."""

    _list, _find, _id_type, _type = "rb_world_bodies", "rb_world_find_body", _abi.BodyId, Body

    def add(self, **fields: Unpack[BodyFields]) -> Body:
        """Adds a body with the keys of scene files: shape, position, mass, motion, material and others.
        ``shape`` may be a `Shape` of the world. Raises `Error` with the path of an invalid field."""
        out, values = _abi.BodyId(), dict(fields)
        shape = values.get("shape")
        if isinstance(shape, Shape):
            del values["shape"]
            check(lib.rb_world_add_body_of(self._world._pointer, shape._id, encode(values),
                                           ctypes.byref(out)))
        else:
            check(lib.rb_world_add_body(self._world._pointer, encode(values), ctypes.byref(out)))
        return Body(self._world, out)

    def add_many(self, definitions: Sequence[dict[str, Any]]) -> list[Body]:
        """Adds many bodies. The whole list is checked first, so an `Error` changes nothing."""
        added = list_of(lib.rb_world_add_bodies, _abi.BodyId, self._world._pointer, encode(list(definitions)))
        return [self._make(*id) for id in added.tolist()]

    def remove_many(self, bodies: Iterable[Body]) -> None:
        """Removes bodies and their joints. Raises `Error` if one of them is not alive, and removes none
        then."""
        ids = ids_of(bodies)
        check(lib.rb_world_remove_bodies(self._world._pointer, ids.ctypes.data, len(ids)))

    def states(self, bodies: Iterable[Body]) -> np.ndarray:
        """Structured array: "position", "orientation", "velocity", "angular_velocity" of each body."""
        ids = ids_of(bodies)
        out = np.empty(len(ids), np.dtype(_abi.BodyState))
        check(lib.rb_world_body_states(self._world._pointer, ids.ctypes.data, len(ids), out.ctypes.data))
        return out

    def set_states(self, bodies: Iterable[Body], states: np.ndarray) -> None:
        """Sets states of the form that `states` returns."""
        ids = ids_of(bodies)
        given = np.ascontiguousarray(states, np.dtype(_abi.BodyState))
        if given.shape != ids.shape:
            raise Error(f"states: expected {len(ids)} states, got shape {given.shape}", "states",
                        f"{len(ids)} states", f"shape {given.shape}")
        check(lib.rb_world_set_body_states(self._world._pointer, ids.ctypes.data, len(ids),
                                           given.ctypes.data))

    def apply_forces(self, bodies: Iterable[Body], forces: Any, torques: Any = None) -> None:
        """Forces (n, 3) [N] and torques (n, 3) [N m] for the next step."""
        ids = ids_of(bodies)
        pushed = matrix(forces, "forces", rows=len(ids))
        moments = None if torques is None else matrix(torques, "torques", rows=len(ids))
        check(lib.rb_world_apply_forces(self._world._pointer, ids.ctypes.data, len(ids), pushed.ctypes.data,
                                        None if moments is None else moments.ctypes.data))

    def apply_impulses(self, bodies: Iterable[Body], impulses: Any) -> None:
        """Impulses (n, 3) at the centers of mass [N s]."""
        ids = ids_of(bodies)
        given = matrix(impulses, "impulses", rows=len(ids))
        check(lib.rb_world_apply_impulses(self._world._pointer, ids.ctypes.data, len(ids), given.ctypes.data))


class Shapes(Collection):
    """The shapes of a world, by index; they have no names. Bodies with equal shapes share one."""

    _list, _find = "rb_world_shapes", ""
    _id_type, _type = _abi.ShapeId, Shape

    def __getitem__(self, key: Any) -> Shape:
        return self._make(*self.ids[key].tolist())

    def add(self, definition: Definition) -> Shape:
        """Adds a use of a shape, and cooks it if it is new. It lives until its `remove`, also without
        bodies."""
        handle, out = ShapeHandle(definition), _abi.ShapeId()
        check(lib.rb_world_add_shape(self._world._pointer, handle.pointer, ctypes.byref(out)))
        return Shape(self._world, out)
