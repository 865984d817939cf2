"""Sensors of scenes, at frames of bodies and at axes of joints."""
from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np

from ._library import Handle, Named, check, invalid, json_of, lib
from ._worlds import Worlds

if TYPE_CHECKING:
    from ._scene import Scene
    from ._world import World


class Sensors(Named):
    """Readings of the sensors of a scene: ``sensors = rubble.Sensors(scene, world)``, ``sensors.update()``
    after each step, then ``sensors["gyro"]``.

    Args:
        scene: A scene with sensors: by `Scene.add_sensor`, of a scene file, or of a model (MJCF).
        world: Made of `scene`, with nothing removed yet. Or `Worlds`: arrays have a leading axis of worlds
            then, and each world has the readings that it has alone.
        first, count: Of `Worlds`: the worlds of that scene, -1: up to the last one.

    Attributes:
        names: Of the sensors, in their order; those without a name are ``sensor_3``.
        types: What each measures, with the keywords of scene files.
        values: (n,) or (worlds, n) numbers of all sensors, one after the other, as last measured; zeros
            before.

    Raises:
        Error: For a sensor of a body or joint that the world does not have.

    Arrays are in host memory. With the backend "cuda" an update of `Worlds` copies poses and velocities of
    all bodies from the device, and the whole state if a sensor reads joints or contacts. Rays are cast there.
    """

    def __init__(self, scene: "Scene", world: Union["World", Worlds], first: int = 0,
                 count: int = -1) -> None:
        self._worlds: Optional[Worlds] = None
        if isinstance(world, Worlds):
            self._worlds = world
            self._handle = Handle(lib.rb_sensors_create_in, lib.rb_sensors_destroy, scene._pointer,
                                  world._handle.pointer, first, count)
            count = len(world) - first if count < 0 else count
        else:
            self._handle = Handle(lib.rb_sensors_create, lib.rb_sensors_destroy, scene._pointer,
                                  world._pointer)
        definitions = json_of(lib.rb_sensors_list, self._handle.pointer)
        self.names: list[str] = [d["name"] or f"sensor_{i}" for i, d in enumerate(definitions)]
        self.types: list[str] = [d["type"] for d in definitions]
        self._ends = np.cumsum([0, *(d["count"] for d in definitions)])
        self.values = np.zeros(self._ends[-1] if self._worlds is None else (count, self._ends[-1]))

    def update(self, active: Any = None) -> np.ndarray:
        """Measures and returns `values`. Accelerations are those since the last call, so call it after each
        step.

        Args:
            active: Of `Worlds`: (worlds,) booleans, one for each of them; the others keep their readings.
                None: all.
        """
        address, count, mask = ctypes.c_void_p(), ctypes.c_int64(), None
        if active is not None:
            flags = np.ascontiguousarray(active, dtype=np.uint8)
            if self._worlds is None or flags.shape != (len(self._worlds),):
                raise invalid("active", "one for each of the worlds", f"shape {flags.shape}")
            mask = flags.ctypes.data
        check(lib.rb_sensors_update_in(self._handle.pointer, mask, ctypes.byref(address),
                                       ctypes.byref(count)))
        if count.value:
            found = np.frombuffer(ctypes.string_at(address, 8 * count.value))
            self.values = found.reshape(self.values.shape)
        return self.values

    def __getitem__(self, sensor: Union[str, int]) -> np.ndarray:
        """The reading of one sensor, by name or place: 1, 3 or 4 numbers, or (worlds, numbers). Raises
        `KeyError` for an unknown name."""
        if isinstance(sensor, str):
            sensor = self._at(sensor, "sensor")
        at = range(len(self))[sensor]
        return self.values[..., self._ends[at]:self._ends[at + 1]]

    def of_type(self, type: str) -> np.ndarray:
        """The readings of all sensors of a type in one array: (sensors, numbers), or (worlds, sensors,
        numbers). "acceleration", "force", "touch", "range" or another of `types`."""
        found = [self[i] for i, own in enumerate(self.types) if own == type]
        if not found:
            raise invalid("type", "one of " + ", ".join(sorted(set(self.types))), repr(type))
        return np.stack(found, axis=-2)
