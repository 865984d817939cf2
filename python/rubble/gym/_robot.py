"""What environments with robots share."""
from __future__ import annotations

from typing import Any, Sequence

import numpy as np

from .. import Scene, capsule
from ._vector import WorldsEnv


def limb(scene: Scene, name: str, start: Sequence[float], end: Sequence[float], radius: float, mass: float,
         **fields: Any) -> int:
    """A capsule from one point to another [m]."""
    a, b = np.asarray(start, float), np.asarray(end, float)
    size = float(np.linalg.norm(b - a))
    along = (b - a) / size
    # the rotation from z to the direction of the limb
    turn = np.array([1 + along[2], -along[1], along[0], 0]) if along[2] > -0.999 else np.array([0, 1, 0, 0])
    return scene.add_body(capsule(radius, size), name=name, position=((a + b) / 2).tolist(), mass=mass,
                          orientation=(turn / np.linalg.norm(turn)).tolist(), **fields)


def turned(q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Vectors (..., 3) rotated by quaternions (..., 4), scalar first."""
    s, u = q[..., :1], q[..., 1:]
    return v + 2 * np.cross(u, np.cross(u, v) + s * v)


def product(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Products of quaternions (..., 4), scalar first."""
    p, q = np.broadcast_arrays(p, q)
    a, u, b, v = p[..., :1], p[..., 1:], q[..., :1], q[..., 1:]
    return np.concatenate([a * b - (u * v).sum(-1, keepdims=True), a * v + b * u + np.cross(u, v)], -1)


class Robot(WorldsEnv):
    """A robot whose actions are targets of the drives of its joints.

    Action: from -1 to 1 for each axis, from the lower to the upper limit; 0 is the pose of the scene.
    """

    def _drive(self, actions: np.ndarray, worlds: np.ndarray, axes: Sequence[int]) -> None:
        """Gives targets for these axes, one action each."""
        low, high = self._limits
        given = np.clip(np.asarray(actions, float)[worlds], -1, 1)
        targets = np.where(given < 0, -given * low[list(axes)], given * high[list(axes)])
        self.set_joints("target_position", worlds, axes, targets)

    @property
    def _limits(self) -> tuple[np.ndarray, np.ndarray]:
        if not hasattr(self, "_limits_of_axes"):
            self._limits_of_axes = (self.joints("lower_limit")[0].astype(float),
                                    self.joints("upper_limit")[0].astype(float))
        return self._limits_of_axes

    def _move(self, worlds: np.ndarray, bodies: Sequence[str], yaw: np.ndarray, shift: np.ndarray,
              velocity: np.ndarray) -> None:
        """Moves bodies as one: a rotation `yaw` (n,) [rad] about the z axis, then a shift (n, 3) [m], with a
        velocity (n, 3) [m/s] in common. Joints stay as they are."""
        of = [self.bodies[body] for body in bodies]
        turn = np.zeros((len(worlds), 1, 4))
        turn[:, 0, 0], turn[:, 0, 3] = np.cos(yaw / 2), np.sin(yaw / 2)
        place = turned(turn, self.states("position")[worlds][:, of]) + shift[:, None]
        self.set_states("position", worlds, bodies, place)
        turns = product(turn, self.states("orientation")[worlds][:, of])
        self.set_states("orientation", worlds, bodies, turns)
        self.set_states("velocity", worlds, bodies, np.repeat(velocity[:, None], len(of), axis=1))
