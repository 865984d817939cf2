"""Actuators of scenes: motors, drives, muscles, rotors and adhesion, with their controls."""
from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np

from ._library import Handle, Named, check, invalid, json_of, lib
from ._worlds import Worlds

if TYPE_CHECKING:
    from ._scene import Scene
    from ._world import World


class Actuators(Named):
    """Controls of the actuators of a scene: ``actuators = rubble.Actuators(scene, world)``, then before each
    step ``actuators["knee"] = 0.4`` and ``actuators.apply()``.

    Args:
        scene: A scene with actuators: by `Scene.add_actuator`, of a scene file, or of a model (MJCF).
        world: Made of `scene`, without a step yet: a `World`, or `Worlds`.
        first: Of `Worlds`: the first world that has them.
        count: Of `Worlds`: how many have them; None: all from the first one on.

    Attributes:
        names: Of the actuators, in their order; those without a name are ``actuator_3``.
        types: What each does, with the keywords of scene files.

    Arrays have the shape (n,), or (worlds, n) for `Worlds`. `World.restore` and `Worlds.reset` set controls
    and activations to those of the snapshot.

    Raises:
        Error: For an actuator of a body or joint that the world does not have, or a world that is not there.
    """

    def __init__(self, scene: "Scene", world: Union["World", Worlds], first: int = 0,
                 count: Optional[int] = None) -> None:
        if isinstance(world, Worlds):
            rows = len(world) - first if count is None else count
            self._handle = Handle(lib.rb_actuators_create_in, lib.rb_actuators_destroy, scene._pointer,
                                  world._handle.pointer, first, rows)
        else:
            self._handle = Handle(lib.rb_actuators_create, lib.rb_actuators_destroy, scene._pointer,
                                  world._pointer)
        definitions = json_of(lib.rb_actuators_list, self._handle.pointer)
        self.names: list[str] = [d["name"] or f"actuator_{i}" for i, d in enumerate(definitions)]
        self.types: list[str] = [d["type"] for d in definitions]
        shape = (rows, len(definitions)) if isinstance(world, Worlds) else (len(definitions),)
        self._worlds: Any = world if isinstance(world, Worlds) else ()
        numbers = [ctypes.POINTER(ctypes.c_double)() for _ in range(3)]
        check(lib.rb_actuators_arrays(self._handle.pointer, *(ctypes.byref(p) for p in numbers)))
        self._controls, self._activations, self._forces = (self._array(p, shape) for p in numbers)
        self._forces.flags.writeable = False

    def _array(self, numbers: Any, shape: tuple[int, ...]) -> np.ndarray:
        """The numbers themselves, which keep the actuators alive."""
        if not np.prod(shape):
            return np.zeros(shape)
        own: Any = (ctypes.c_double * int(np.prod(shape))).from_address(ctypes.addressof(numbers.contents))
        own._owner = self._handle
        return np.frombuffer(own).reshape(shape)

    @property
    def controls(self) -> np.ndarray:
        """Numbers that stay until they are changed, or a snapshot is restored."""
        return self._controls

    @controls.setter
    def controls(self, values: Any) -> None:
        self._controls[...] = values

    @property
    def activations(self) -> np.ndarray:
        """States of muscles, filters and integrators; 0 for the others."""
        return self._activations

    @activations.setter
    def activations(self, values: Any) -> None:
        self._activations[...] = values

    @property
    def forces(self) -> np.ndarray:
        """What each did in the last `apply`: forces, or by how much it moves a target. Read only."""
        return self._forces

    def apply(self, active: Any = None) -> np.ndarray:
        """Acts on the world for its next step, advances `activations` by the time of it, and returns
        `forces`. Call it before each step.

        Args:
            active: Of `Worlds`: one boolean for each of them, which take part; None: all.
        """
        mask = None
        if active is not None:
            flags = np.ascontiguousarray(active, dtype=np.uint8)
            if flags.shape != (len(self._worlds),):
                raise invalid("active", f"shape ({len(self._worlds)},)", f"shape {flags.shape}")
            mask = flags.ctypes.data
        check(lib.rb_actuators_apply_in(self._handle.pointer, mask))
        return self._forces

    def __getitem__(self, name: str) -> Any:
        """The control of an actuator; of `Worlds` those of all worlds. Raises `KeyError` for an unknown
        name."""
        own = self._controls[..., self._at(name, "actuator")]
        return own if own.ndim else float(own)

    def __setitem__(self, name: str, control: Any) -> None:
        self._controls[..., self._at(name, "actuator")] = control
