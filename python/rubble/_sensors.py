"""Sensors of scenes."""
from __future__ import annotations

import ctypes
from typing import Iterator, Union

import numpy as np

from ._library import Handle, check, json_of, lib, list_of
from ._scene import Scene
from ._world import World


class Sensors:
    """Readings of the sensors of a scene: ``sensors = rubble.Sensors(world, scene)``, ``sensors.update()``
    after each step, then ``sensors["gyro"]``.

    Args:
        world: Made of `scene`. Its bodies and joints are those that it has at present.
        scene: A scene with sensors: by `Scene.add_sensor`, of a scene file, or of a model (MJCF).

    Attributes:
        names: Of the sensors, in their order; those without a name are ``sensor_3``.
        types: What each measures, with the keywords of scene files.

    Raises:
        Error: For a sensor of a body or joint that the world does not have.
    """

    def __init__(self, world: World, scene: Scene) -> None:
        self._world = world
        self._handle = Handle(lib.rb_sensors_create, lib.rb_sensors_destroy, scene._pointer, world._pointer)
        definitions = json_of(lib.rb_sensors_list, self._handle.pointer)
        self.names: list[str] = [d["name"] or f"sensor_{i}" for i, d in enumerate(definitions)]
        self.types: list[str] = [d["type"] for d in definitions]
        self._ends = np.cumsum([0, *(d["size"] for d in definitions)])

    def update(self) -> np.ndarray:
        """Measures the world and returns `values`. Accelerations are those since the last call, so call it
        after each step."""
        check(lib.rb_sensors_update(self._handle.pointer, self._world._pointer))
        return self.values

    @property
    def values(self) -> np.ndarray:
        """(n,) numbers of all sensors, one after the other, as they were at the last `update`; zeros
        before."""
        return list_of(lib.rb_sensors_values, ctypes.c_double, self._handle.pointer)

    def __getitem__(self, sensor: Union[str, int]) -> np.ndarray:
        """The reading of one sensor, by name or place: 1, 3 or 4 numbers."""
        if isinstance(sensor, str):
            if sensor not in self.names:
                raise KeyError(f"no sensor {sensor!r}; there are {', '.join(self.names)}")
            sensor = self.names.index(sensor)
        at = range(len(self))[sensor]
        return self.values[self._ends[at]:self._ends[at + 1]]

    def __iter__(self) -> Iterator[np.ndarray]:
        return (self[at] for at in range(len(self)))

    def __len__(self) -> int:
        return len(self.names)

    def __repr__(self) -> str:
        return f"<rubble.Sensors {', '.join(self.names)}>"
