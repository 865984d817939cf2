"""A linkage of four bars: a closed loop of joints."""
from __future__ import annotations

from typing import Any

import numpy as np

from .. import Scene
from ._robot import limb
from ._vector import WorldsEnv, box, on_host

_TORQUE, _CRANK = 20.0, 0
_FEET, _CRANK_TIP, _ROCKER_TIP = ((0, 0, 0), (1.0, 0, 0)), (0, 0, 0.3), (0.9, 0, 0.8)


def scene() -> Scene:
    """Crank, coupler and rocker in the x-z plane. The crank can turn around; the rocker swings."""
    out = Scene()
    apart = {"group": -1}  # the bars lie beside one another
    limb(out, "crank", _FEET[0], _CRANK_TIP, 0.03, 1, **apart)
    limb(out, "coupler", _CRANK_TIP, _ROCKER_TIP, 0.03, 1, **apart)
    limb(out, "rocker", _FEET[1], _ROCKER_TIP, 0.03, 1, **apart)
    hinges = (("motor", "crank", "world", _FEET[0]), ("elbow", "coupler", "crank", _CRANK_TIP),
              ("wrist", "coupler", "rocker", _ROCKER_TIP), ("foot", "rocker", "world", _FEET[1]))
    for name, body, other, place in hinges:
        out.add_joint("hinge", body, other, name=name, anchor=list(place), axis=(0, 1, 0))
    return out


class FourBar(WorldsEnv):
    """A four-bar linkage: turn the crank at a speed that each episode draws.

    Observation, 7 numbers: sine and cosine of the angle of the crank, its speed [rad/s], angle [rad] and
    speed of the rocker, the wanted speed [rad/s], and the force at the elbow [N] over 100.
    Action: torque of the motor from -1 to 1, times 20 N m. Reward: 1 - |speed - wanted| / wanted.
    """

    def __init__(self, num_envs: int = 1, **options: Any) -> None:
        self.single_observation_space, self.single_action_space = box(7), box(1, -1, 1)
        self._wanted = np.full(num_envs, 3.0)
        super().__init__(scene(), num_envs, **{"dt": 0.01, "max_episode_steps": 400, **options})

    def _act(self, actions: np.ndarray, worlds: np.ndarray) -> None:
        torque = _TORQUE * np.clip(np.asarray(actions, float)[worlds], -1, 1)
        self.set_joints("applied_force", worlds, [_CRANK], torque)

    def _observe(self) -> np.ndarray:
        x, v = self.joints("position"), self.joints("speed")
        elbow = on_host(self.worlds.sensor_array("joint_force")).reshape(self.num_envs, -1, 3)[:, 1]
        return np.stack([np.sin(x[:, 0]), np.cos(x[:, 0]), v[:, 0], x[:, 3], v[:, 3], self._wanted,
                         np.linalg.norm(elbow, axis=1) / 100], axis=1)

    def _reward(self, observations: np.ndarray, actions: np.ndarray) -> np.ndarray:
        return 1 - np.abs(observations[:, 2] - self._wanted) / self._wanted

    def _start(self, worlds: np.ndarray) -> None:
        noise = self.draw(worlds, 2)
        self._wanted[worlds] = 4 + 2 * noise[:, 0]
        spin = np.zeros((len(worlds), 1, 3))
        spin[:, 0, 1] = 0.1 * noise[:, 1]
        self.set_states("angular_velocity", worlds, ["crank"], spin)
