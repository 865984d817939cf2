"""A hand with two fingers, which environments move by speeds of its target."""
from __future__ import annotations

from typing import Any, Sequence

import numpy as np

from .. import Scene, box
from ._vector import WorldsEnv

FINGER, OPEN = 0.07, 0.055  #: length of a finger, and its place from the middle of the hand at the start [m]
#: Parts never collide with one another, and their weight is balanced.
ROBOT = {"group": -1, "gravity_scale": 0}
_GOAL, _GRIP = 0.2, 5  # height [m] and force [N] that count in full
_SPEED = np.array((0.6, 0.6, 0.4, 0.2))  # of the target along x, y, z and of the fingers [m/s]
_DRIVE = {"drive_stiffness": 2000, "drive_damping": 40, "max_drive_force": 15}


_SIDES = ((-1, "left"), (1, "right"))


def add_hand(scene: Scene, place: Sequence[float], along: int) -> None:
    """Adds a hand at a place [m] with two fingers along an axis (0: x, 1: y)."""
    def size(across: float, wide: float, high: float) -> dict[str, Any]:
        return box(across, wide, high) if along == 0 else box(wide, across, high)
    scene.add_body(size(0.16, 0.05, 0.03), name="hand", position=place, mass=0.5, **ROBOT)
    for side, name in _SIDES:
        position = np.array(place, float) - (0, 0, 0.015 + FINGER / 2)
        position[along] += side * OPEN
        scene.add_body(size(0.02, 0.04, FINGER), name=name, position=position, mass=0.1,
                       material={"friction": 1.2}, **ROBOT)


def add_grip(scene: Scene, place: Sequence[float], along: int) -> None:
    """Adds the joints that close the fingers of `add_hand`."""
    for side, name in _SIDES:
        axis = np.zeros(3)
        axis[along] = side
        scene.add_joint("slider", name, "hand", name=name + " rail", anchor=place, axis=axis,
                        axes=[{"min": -OPEN, "max": 0, **_DRIVE}])


def lifting(way: np.ndarray, forces: np.ndarray, height: np.ndarray) -> np.ndarray:
    """Reward (n,) for lifting a thing to 0.2 m, from 0 to 6.5: 1 - its distance from the hand [m], plus up to
    0.5 for a grip of 5 N, plus up to 5 for its height.

    Args:
        way: (n, 3) from the hand to the thing [m].
        forces: (n, 2) of the fingers [N]; the smaller one counts.
        height: (n,) above where it lay [m].
    """
    grip = np.clip(forces.min(axis=1) / _GRIP, 0, 1)
    return 1 - np.linalg.norm(way, axis=1) + 0.5 * grip + 5 * np.clip(height / _GOAL, 0, 1)


class HandEnv(WorldsEnv):
    """Moves a hand by actions from -1 to 1: speeds of its target along x, y and z, and of the fingers
    (positive: they close)."""

    _low, _high = np.zeros(4), np.ones(4)  #: bounds of the target from its start [m]

    def __init__(self, scene: Scene, num_envs: int, **options: Any) -> None:
        self._targets = np.zeros((num_envs, 4))
        super().__init__(scene, num_envs, **{"dt": 0.01, "frame_skip": 2, "iterations": 8, **options})

    def _axes(self, targets: np.ndarray) -> np.ndarray:
        """Positions (n, axes) of the joints before the fingers for targets (n, 3) of the hand [m]."""
        raise NotImplementedError

    def _act(self, actions: np.ndarray, worlds: np.ndarray) -> None:
        step = self.metadata["render_fps"] * self.frame_skip
        way = np.clip(np.asarray(actions, float)[worlds], -1, 1) * _SPEED / step
        self._targets[worlds] = np.clip(self._targets[worlds] + way, self._low, self._high)
        targets = self._targets[worlds]
        given = np.concatenate([self._axes(targets[:, :3]), -np.repeat(targets[:, 3:], 2, axis=1)], axis=1)
        self.set_joints("target_position", worlds, range(given.shape[1]), given)

    def _start(self, worlds: np.ndarray) -> None:
        self._targets[worlds] = 0
