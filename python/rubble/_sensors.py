"""Sensors of scenes, at frames of bodies and at axes of joints."""
from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Union

import numpy as np

from ._library import Handle, Named, check, json_of, lib

if TYPE_CHECKING:
    from ._scene import Scene
    from ._world import World


class Sensors(Named):
    """Readings of the sensors of a scene: ``sensors = rubble.Sensors(scene, world)``, ``sensors.update()``
    after each step, then ``sensors["gyro"]``.

    Args:
        scene: A scene with sensors: by `Scene.add_sensor`, of a scene file, or of a model (MJCF).
        world: Made of `scene`, with nothing removed yet.

    Attributes:
        names: Of the sensors, in their order; those without a name are ``sensor_3``.
        types: What each measures, with the keywords of scene files.
        values: (n,) numbers of all sensors, one after the other, as last measured; zeros before.

    Raises:
        Error: For a sensor of a body or joint that the world does not have.
    """

    def __init__(self, scene: "Scene", world: "World") -> None:
        self._handle = Handle(lib.rb_sensors_create, lib.rb_sensors_destroy, scene._pointer, world._pointer)
        definitions = json_of(lib.rb_sensors_list, self._handle.pointer)
        self.names: list[str] = [d["name"] or f"sensor_{i}" for i, d in enumerate(definitions)]
        self.types: list[str] = [d["type"] for d in definitions]
        self._ends = np.cumsum([0, *(d["count"] for d in definitions)])
        self.values = np.zeros(self._ends[-1])

    def update(self) -> np.ndarray:
        """Measures the world and returns `values`. Accelerations are those since the last call, so call it
        after each step."""
        address, count = ctypes.c_void_p(), ctypes.c_int64()
        check(lib.rb_sensors_update(self._handle.pointer, ctypes.byref(address), ctypes.byref(count)))
        if count.value:
            self.values = np.frombuffer(ctypes.string_at(address, 8 * count.value))
        return self.values

    def __getitem__(self, sensor: Union[str, int]) -> np.ndarray:
        """The reading of one sensor, by name or place: 1, 3 or 4 numbers. Raises `KeyError` for an unknown
        name."""
        if isinstance(sensor, str):
            sensor = self._at(sensor, "sensor")
        at = range(len(self))[sensor]
        return self.values[self._ends[at]:self._ends[at + 1]]
