"""A gripper on a gantry, for environments that carry things."""
from __future__ import annotations

from typing import Any, Sequence

import numpy as np

from .. import Scene, box, plane
from ._vector import WorldsEnv

GRIP, HAND_HEIGHT, FINGER = 3, 0.3, 0.07  # axis of the first finger; [m]; length of a finger [m]
REACH = 0.4  #: of the hand from the middle, along x and y [m]
OPEN = 0.055  #: of a finger from the middle of the hand [m]
_SPEED = (0.6, 0.6, 0.4, 0.2)  # of the targets along x, y, z and of the fingers [m/s]
_DRIVE = {"drive_stiffness": 8000, "drive_damping": 250, "max_drive_force": 200}
_FINGER_DRIVE = {"drive_stiffness": 2000, "drive_damping": 40, "max_drive_force": 15}
_PARTS = (("bridge", "world", (1, 0, 0)), ("trolley", "bridge", (0, 1, 0)), ("hand", "trolley", (0, 0, 1)),
          ("left", "hand", (-1, 0, 0)), ("right", "hand", (1, 0, 0)))


def scene() -> Scene:
    """A ground, and a hand with two fingers that moves along x, y and z."""
    out = Scene()
    out.add_body(plane(), name="ground", material={"friction": 0.8})
    options = {"group": -1, "gravity_scale": 0}  # parts of the robot never collide with one another
    out.add_body(box(0.1, 0.1, 0.05), name="bridge", position=(0, 0, 0.9), mass=2, **options)
    out.add_body(box(0.1, 0.1, 0.05), name="trolley", position=(0, 0, 0.8), mass=1, **options)
    out.add_body(box(0.16, 0.05, 0.03), name="hand", position=(0, 0, HAND_HEIGHT), mass=0.5, **options)
    for side, name in ((-1, "left"), (1, "right")):
        out.add_body(box(0.02, 0.04, FINGER), name=name, mass=0.1, material={"friction": 1.2},
                     position=(side * OPEN, 0, HAND_HEIGHT - 0.015 - FINGER / 2), **options)
    for name, other, axis in _PARTS:
        finger = name in ("left", "right")
        low, high = ((-OPEN, 0) if finger else (-HAND_HEIGHT + FINGER + 0.02, 0.3) if name == "hand"
                     else (-REACH, REACH))
        out.add_joint("slider", name, other, name=name + " rail", anchor=(0, 0, HAND_HEIGHT), axis=axis,
                      axes=[{"min": low, "max": high, **(_FINGER_DRIVE if finger else _DRIVE)}])
    return out


class Gantry(WorldsEnv):
    """Moves the hand by actions from -1 to 1: speeds of its target along x, y and z, and of the fingers
    (positive: they close)."""

    def __init__(self, scene: Scene, num_envs: int, **options: Any) -> None:
        self._targets = np.zeros((num_envs, 4))
        super().__init__(scene, num_envs, **{"dt": 0.01, "frame_skip": 2, "iterations": 8, **options})

    def _act(self, actions: np.ndarray, worlds: np.ndarray) -> None:
        step = self.metadata["render_fps"] * self.frame_skip
        way = np.clip(np.asarray(actions, float)[worlds], -1, 1) * np.array(_SPEED) / step
        low = np.array([-REACH, -REACH, -HAND_HEIGHT + FINGER + 0.02, 0])
        self._targets[worlds] = np.clip(self._targets[worlds] + way, low, [REACH, REACH, 0.3, OPEN])
        targets = self._targets[worlds]
        given = np.concatenate([targets[:, :3], -np.repeat(targets[:, 3:], 2, axis=1)], axis=1)
        self.set_joints("target_position", worlds, range(5), given)

    def _hand(self) -> np.ndarray:
        """10 numbers: place [m] and speed [m/s] of the hand and of the first finger, and the normal forces on
        both fingers [N] over 10."""
        x, v = self.joints("position"), self.joints("speed")
        touch = [self.sensors("touch", name) / 10 for name in ("left", "right")]
        return np.concatenate([x[:, :4], v[:, :4], *touch], axis=1)

    def _start(self, worlds: np.ndarray) -> None:
        self._targets[worlds] = 0

    def _put(self, worlds: np.ndarray, bodies: Sequence[str], places: np.ndarray) -> None:
        """Puts bodies at places (n, bodies, 3) [m]."""
        self.set_states("position", worlds, bodies, places)
