"""Sensors at frames of bodies and at axes of joints."""
from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Iterator

import numpy as np

from ._library import Handle, check, json_of, lib

if TYPE_CHECKING:
    from ._scene import Scene
    from ._world import World


class Sensors:
    """Readings of the sensors of a scene, those of an imported model included, in a world of it.

    Args:
        scene: Of a file with "sensors", or an imported model.
        world: A world of that scene, in which nothing was removed yet.

    ``sensors.update()`` after each step measures, ``sensors["imu"]`` is the reading of a sensor then.
    """

    def __init__(self, scene: "Scene", world: "World") -> None:
        self._handle = Handle(lib.rb_sensors_create, lib.rb_sensors_destroy, scene._pointer, world._pointer)
        self._world = world  # whose handle must live as long
        self._list = json_of(lib.rb_sensors_list, self._handle.pointer)
        self._places = {each["name"]: each for each in self._list}
        self.values = np.zeros(sum(each["count"] for each in self._list))  #: of all sensors, as last measured

    def update(self) -> None:
        """Measures the world. Accelerations are those since the last call."""
        address, count = ctypes.c_void_p(), ctypes.c_int64()
        check(lib.rb_sensors_update(self._handle.pointer, ctypes.byref(address), ctypes.byref(count)))
        if count.value:
            self.values = np.frombuffer(ctypes.string_at(address, 8 * count.value))

    def __getitem__(self, name: str) -> np.ndarray:
        """The numbers of a sensor, zeros before the first `update`. Raises `KeyError` for an unknown name."""
        place = self._places[name]
        return self.values[place["first"]:place["first"] + place["count"]]

    def __iter__(self) -> Iterator[str]:
        """Names, in the order of the scene."""
        return (each["name"] for each in self._list)

    def __len__(self) -> int:
        return len(self._list)
