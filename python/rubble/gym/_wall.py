"""Stacking a wall of bricks."""
from __future__ import annotations

from typing import Any

import numpy as np

from .. import box as box_shape
from ._gantry import Gantry, scene
from ._vector import box

_SIZE, _BRICKS = (0.05, 0.12, 0.04), 4
_PLACES = np.array([(0, -0.065, 0.02), (0, 0.065, 0.02), (0, 0, 0.06), (0, 0, 0.1)])  # of the wall [m]


class StackWall(Gantry):
    """Build a wall of four bricks, two in the lowest course, from bricks that lie around.

    Observation, 38 numbers: as of `LiftCube` without the cube, then for each brick its place (3) [m] relative
    to that in the wall and its orientation (4). Action (4): as of `LiftCube`. Reward: the number of bricks
    within 2 cm of their places, less the mean distance of all bricks to them [m].
    """

    def __init__(self, num_envs: int = 1, **options: Any) -> None:
        self.single_observation_space, self.single_action_space = box(10 + 7 * _BRICKS), box(4, -1, 1)
        world = scene()
        self._bricks = [f"brick{k}" for k in range(_BRICKS)]
        for k, name in enumerate(self._bricks):
            world.add_body(box_shape(*_SIZE), name=name, mass=0.2, material={"friction": 0.9},
                           position=(0.2, 0.15 * (k - 1.5), _SIZE[2] / 2))
        super().__init__(world, num_envs, **{"max_episode_steps": 1500, **options})

    def _observe(self) -> np.ndarray:
        of = [self.bodies[name] for name in self._bricks]
        away = self.states("position")[:, of] - _PLACES
        turns = self.states("orientation")[:, of]
        bricks = np.concatenate([away, turns], axis=2).reshape(self.num_envs, -1)
        return np.concatenate([self._hand(), bricks], axis=1)

    def _reward(self, observations: np.ndarray, actions: np.ndarray) -> np.ndarray:
        away = observations[:, 10:].reshape(self.num_envs, _BRICKS, 7)[..., :3]
        far = np.linalg.norm(away, axis=2)
        return (far < 0.02).sum(axis=1) - far.mean(axis=1)

    def _start(self, worlds: np.ndarray) -> None:
        super()._start(worlds)
        places = np.zeros((len(worlds), _BRICKS, 3))
        places[..., 0] = 0.22 + self.draw(worlds, _BRICKS, -0.03, 0.03)
        places[..., 1] = 0.15 * (np.arange(_BRICKS) - 1.5)
        places[..., 2] = _SIZE[2] / 2
        self._put(worlds, self._bricks, places)
