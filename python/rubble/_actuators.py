"""Actuators of scenes: motors, drives, muscles, rotors and adhesion, with their controls."""
from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING

import numpy as np

from ._library import Handle, Named, check, json_of, lib

if TYPE_CHECKING:
    from ._scene import Scene
    from ._world import World


class Actuators(Named):
    """Controls of the actuators of a scene: ``actuators = rubble.Actuators(scene, world)``, then before each
    step ``actuators["knee"] = 0.4`` and ``actuators.apply()``.

    Args:
        scene: A scene with actuators: by `Scene.add_actuator`, of a scene file, or of a model (MJCF).
        world: Made of `scene`, without a step yet.

    Attributes:
        names: Of the actuators, in their order; those without a name are ``actuator_3``.
        types: What each does, with the keywords of scene files.
        controls: (n,) numbers, which stay until they are changed.
        activations: (n,) states of muscles, filters and integrators; 0 for the others.
        forces: (n,) what each did in the last `apply`: forces, or by how much it moves a target.

    Raises:
        Error: For an actuator of a body or joint that the world does not have.
    """

    def __init__(self, scene: "Scene", world: "World") -> None:
        self._handle = Handle(lib.rb_actuators_create, lib.rb_actuators_destroy, scene._pointer,
                              world._pointer)
        definitions = json_of(lib.rb_actuators_list, self._handle.pointer)
        self.names: list[str] = [d["name"] or f"actuator_{i}" for i, d in enumerate(definitions)]
        self.types: list[str] = [d["type"] for d in definitions]
        self.controls, self.activations, self.forces = (np.zeros(len(definitions)) for _ in range(3))
        self._numbers = [ctypes.POINTER(ctypes.c_double)() for _ in range(3)]
        check(lib.rb_actuators_arrays(self._handle.pointer, *(ctypes.byref(p) for p in self._numbers)))
        if definitions:
            self.controls[:], self.activations[:], self.forces[:] = (self._own(i) for i in range(3))

    def _own(self, which: int) -> np.ndarray:
        return np.ctypeslib.as_array(self._numbers[which], (len(self.names),))

    def apply(self) -> np.ndarray:
        """Acts on the world for its next step, advances `activations` by the time of it, and returns
        `forces`. Call it before each step."""
        if self.names:
            self._own(0)[:], self._own(1)[:] = self.controls, self.activations
            check(lib.rb_actuators_apply(self._handle.pointer))
            self.activations[:], self.forces[:] = self._own(1), self._own(2)
        return self.forces

    def __getitem__(self, name: str) -> float:
        """The control of an actuator. Raises `KeyError` for an unknown name."""
        return float(self.controls[self._at(name, "actuator")])

    def __setitem__(self, name: str, control: float) -> None:
        self.controls[self._at(name, "actuator")] = control
