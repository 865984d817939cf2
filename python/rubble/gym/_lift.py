"""Lifting a cube."""
from __future__ import annotations

from typing import Any

import numpy as np

from .. import box as box_shape
from ._gantry import Gantry, scene
from ._hand import lifting
from ._vector import box

_EDGE = 0.05  # of the cube [m]


class LiftCube(Gantry):
    """Grasp a cube of 5 cm and 0.1 kg that lies at a random place, and lift it to 0.2 m.

    Observation, 16 numbers: place (4) [m] and speed (4) [m/s] of the hand and a finger, normal forces on the
    fingers (2) [N] over 10, then the place (3) [m] and velocity (3) [m/s] of the cube relative to the hand.
    Action (4), from -1 to 1: speeds of the hand's target along x, y, z, and of the fingers (positive: close).
    Reward, up to 6.5: 1 less the distance of hand and cube [m], up to 0.5 for a grip of 5 N, and up to 5 for
    the height above where it lay, at 0.2 m.
    """

    def __init__(self, num_envs: int = 1, **options: Any) -> None:
        self.single_observation_space, self.single_action_space = box(16), box(4, -1, 1)
        world = scene()
        world.add_body(box_shape(_EDGE, _EDGE, _EDGE), name="cube", mass=0.1, position=(0, 0, _EDGE / 2),
                       material={"friction": 1.0})
        super().__init__(world, num_envs, **{"max_episode_steps": 250, **options})

    def _observe(self) -> np.ndarray:
        x, v = self.states("position"), self.states("velocity")
        hand, cube = self.bodies["hand"], self.bodies["cube"]
        return np.concatenate([self._hand(), x[:, cube] - x[:, hand], v[:, cube] - v[:, hand]], axis=1)

    def _reward(self, observations: np.ndarray, actions: np.ndarray) -> np.ndarray:
        height = self.states("position", "cube")[:, 2] - _EDGE / 2
        return lifting(observations[:, 10:13], 10 * observations[:, 8:10], height)

    def _start(self, worlds: np.ndarray) -> None:
        super()._start(worlds)
        place = np.zeros((len(worlds), 1, 3))
        place[:, 0, :2], place[:, 0, 2] = self.draw(worlds, 2, -0.2, 0.2), _EDGE / 2
        self._put(worlds, ["cube"], place)
