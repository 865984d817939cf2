"""Joints of a running world."""
from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, NamedTuple, Optional, Sequence

import numpy as np

from . import _abi
from ._bodies import Body, Collection, NamedElement, Vector, id_of
from ._library import check, encode, lib, vector

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._fields import JointFields, JointValues


class AxisState(NamedTuple):
    """State of a joint axis, in [m] and [N] or in [rad] and [N m]."""

    position: float  #: from its zero at the start [m], [rad]
    speed: float  #: [m/s], [rad/s]
    limit_force: float  #: of the limits, on body A along the axis [N], [N m]
    drive_force: float  #: of the drive, likewise
    friction_force: float  #: of friction, likewise
    motor_force: float  #: of armature, damping and the motor


class JointState(NamedTuple):
    """State of a joint or an attachment after the last step."""

    gap: float  #: linear constraint error [m]
    angle: float  #: angular constraint error [rad]
    force: np.ndarray  #: (3,) on body B or on the vertices [N]
    torque: np.ndarray  #: (3,) on body B, about its anchor [N m]
    axes: tuple[AxisState, ...]  #: one for each axis of its type; empty for attachments
    broken: bool  #: whether it broke; a broken joint holds nothing

    @classmethod
    def of(cls, state: _abi.JointState) -> "JointState":
        """From the struct of the C library."""
        axes = tuple(AxisState(*(getattr(axis, name) for name in AxisState._fields))
                     for axis in state.axes[:state.axis_count])
        return cls(state.gap, state.angle, np.array(state.force), np.array(state.torque), axes,
                   bool(state.broken))


class Joint(NamedElement):
    """A joint of a running world."""

    __slots__ = ()
    _kind = "joint"

    @property
    def state(self) -> JointState:
        """Gap [m], angle [rad], force [N], torque [N m] and axes after the last step; see `JointState`.
        Raises `Error` once the joint is removed."""
        out = _abi.JointState()
        check(lib.rb_world_joint_state(self._world._pointer, self._id, ctypes.byref(out)))
        return JointState.of(out)

    def _four(self) -> list[Optional[Body]]:
        ids = (_abi.BodyId * 4)()
        check(lib.rb_world_joint_bodies(self._world._pointer, self._id, ids))
        return [Body(self._world, _abi.BodyId(id.index, id.generation)) if id.index >= 0 else None
                for id in ids]

    @property
    def bodies(self) -> tuple[Optional[Body], Optional[Body]]:
        """A and B; None: the static world."""
        a, b, *_ = self._four()
        return a, b

    @property
    def frame_bodies(self) -> tuple[Optional[Body], Optional[Body]]:
        """Frame bodies of gears and racks; None: the static world."""
        *_, a, b = self._four()
        return a, b

    def set(self, **values: Unpack[JointValues]) -> None:
        """Replaces values from the next step on, with the keys of scene files: ``set(axes=[{"max": 1}])``.
        Raises `Error` with the path of an invalid field."""
        check(lib.rb_world_set_joint(self._world._pointer, self._id, encode(values)))

    def set_target(self, *, position: Optional[float] = None, speed: Optional[float] = None,
                   axis: int = 0) -> None:
        """Target of the drive of an axis: position [m] or [rad], speed [m/s] or [rad/s]. Raises `Error` for
        an axis that the joint does not have."""
        pointer = self._world._pointer
        if position is not None:
            check(lib.rb_world_set_target_position(pointer, self._id, axis, position))
        if speed is not None:
            check(lib.rb_world_set_target_speed(pointer, self._id, axis, speed))

    def set_motor_force(self, force: float, axis: int = 0) -> None:
        """Motor of an axis: "motor_force" [N] or [N m]."""
        check(lib.rb_world_set_motor_force(self._world._pointer, self._id, axis, force))

    def set_limits(self, min: float, max: float, axis: int = 0) -> None:
        """Limits of an axis [m] or [rad]; infinite: none."""
        check(lib.rb_world_set_limits(self._world._pointer, self._id, axis, min, max))

    def set_length(self, length: float) -> None:
        """Distance, rope, spring, pulley [m]."""
        check(lib.rb_world_set_length(self._world._pointer, self._id, length))

    def set_drive_orientation(self, orientation: Vector) -> None:
        """Swing-twist: target orientation of the frame of A in that of B."""
        quaternion = vector(orientation, "orientation", 4)
        check(lib.rb_world_set_drive_orientation(self._world._pointer, self._id, quaternion))

    def drag_to(self, point: Vector) -> None:
        """Moves the target of a drag joint to a world point [m]."""
        check(lib.rb_world_set_drag_target(self._world._pointer, self._id, vector(point, "point")))

    def __repr__(self) -> str:
        if not self.alive:
            return f"<rubble.Joint {self.index} removed>"
        return f"<rubble.Joint {self.name or self.index!r} {self.definition['type']}>"


class Joints(Collection):
    """The joints of a world: ``world.joints["hinge"]``, ``len``, iteration."""

    _list, _find, _id_type, _type = "rb_world_joints", "rb_world_find_joint", _abi.JointId, Joint

    def add(self, type: str, a: Optional[Body], b: Optional[Body] = None, *,
            frame_bodies: Sequence[Optional[Body]] = (None, None), **fields: Unpack[JointFields]) -> Joint:
        """Adds a joint between two bodies (None: the static world).

        Args:
            type: "ball", "fixed", "hinge", "slider", "distance", "rope", "spring" or another joint type.
            frame_bodies: Frame bodies of gears and racks.
            fields: Keys of scene files. "anchor" [m], "axis" and "frame" are in the world, at the present
                poses.
        Raises:
            Error: For an unknown type or key, an invalid value, or a body that was removed.
        """
        out = _abi.JointId()
        definition = encode({"type": type, **fields})
        check(lib.rb_world_add_joint(self._world._pointer, definition, id_of(a), id_of(b),
                                     id_of(frame_bodies[0]), id_of(frame_bodies[1]), ctypes.byref(out)))
        return Joint(self._world, out)

    def add_coupling(self, type: str, a: Joint, b: Joint, **fields: Unpack[JointValues]) -> Joint:
        """Adds a "gear" between two hinges, or a "rack" between a hinge and a slider. `ratio`: see the scene
        format."""
        out = _abi.JointId()
        check(lib.rb_world_add_coupling(self._world._pointer, encode({"type": type, **fields}), a._id, b._id,
                                        ctypes.byref(out)))
        return Joint(self._world, out)
