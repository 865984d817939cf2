"""A robot with two legs and two arms."""
from __future__ import annotations

from typing import Any

import numpy as np

from .. import Scene, box as box_shape, plane, sphere
from ._robot import Robot, limb
from ._vector import box

_HIP, _KNEE, _ANKLE, _WAIST, _SHOULDER = 0.92, 0.5, 0.08, 1.0, 1.38  # heights [m]
_FREEDOMS = 27
_LEG = {"drive_stiffness": 600, "drive_damping": 25, "max_drive_force": 250}
_ARM = {"drive_stiffness": 60, "drive_damping": 4, "max_drive_force": 40}


def _rotations(drive: dict[str, float], *limits: tuple[float, float]) -> list[dict[str, Any]]:
    """Axes of a six-dof joint that only turns, about x, y and z [rad]."""
    return [{"locked": True}] * 3 + [{"min": low, "max": high, **drive} for low, high in limits]


def scene() -> Scene:
    """17 bodies, 46 kg, 27 degrees of freedom. x is forward."""
    out = Scene()
    out.add_body(plane(), name="ground", material={"friction": 1.0})
    own = {"group": -1}  # limbs do not collide with one another
    out.add_body(box_shape(0.18, 0.3, 0.14), name="pelvis", position=(0, 0, _HIP + 0.03), mass=9, **own)
    out.add_body(box_shape(0.16, 0.26, 0.12), name="belly", position=(0, 0, _WAIST + 0.02), mass=4, **own)
    out.add_body(box_shape(0.2, 0.32, 0.3), name="chest", position=(0, 0, _WAIST + 0.26), mass=9, **own)
    limb(out, "neck", (0, 0, _SHOULDER + 0.02), (0, 0, _SHOULDER + 0.1), 0.05, 0.5, **own)
    out.add_body(sphere(0.11), name="head", position=(0, 0, _SHOULDER + 0.2), mass=3.5, **own)
    out.add_joint("six_dof", "belly", "pelvis", name="loin", anchor=(0, 0, _WAIST - 0.03),
                  axes=_rotations(_LEG, (-0.3, 0.3), (-0.2, 0.5), (0, 0)))
    out.add_joint("six_dof", "chest", "belly", name="waist", anchor=(0, 0, _WAIST + 0.09),
                  axes=_rotations(_LEG, (-0.3, 0.3), (-0.3, 0.5), (-0.6, 0.6)))
    out.add_joint("hinge", "neck", "chest", name="neck", anchor=(0, 0, _SHOULDER + 0.02), axis=(0, 0, 1),
                  axes=[{"min": -1.2, "max": 1.2, **_ARM}])
    out.add_joint("hinge", "head", "neck", name="head", anchor=(0, 0, _SHOULDER + 0.1), axis=(0, 1, 0),
                  axes=[{"min": -0.6, "max": 0.6, **_ARM}])
    for side, y in (("left", 0.1), ("right", -0.1)):
        thigh, shin, foot = f"{side} thigh", f"{side} shin", f"{side} foot"
        limb(out, thigh, (0, y, _HIP), (0, y, _KNEE), 0.07, 4, **own)
        limb(out, shin, (0, y, _KNEE), (0, y, _ANKLE), 0.055, 2.5, **own)
        out.add_body(box_shape(0.26, 0.12, 0.06), name=foot, position=(0.05, y, 0.03), mass=1,
                     material={"friction": 1.0}, **own)
        out.add_joint("six_dof", thigh, "pelvis", name=f"{side} hip", anchor=(0, y, _HIP),
                      axes=_rotations(_LEG, (-0.4, 0.4), (-1.6, 0.6), (-0.4, 0.4)))
        out.add_joint("hinge", shin, thigh, name=f"{side} knee", anchor=(0, y, _KNEE), axis=(0, 1, 0),
                      axes=[{"min": 0, "max": 2.2, **_LEG}])
        out.add_joint("hinge", foot, shin, name=f"{side} ankle", anchor=(0, y, _ANKLE), axis=(0, 1, 0),
                      axes=[{"min": -0.7, "max": 0.6, **_LEG}])
        upper, lower, out_of = f"{side} arm", f"{side} forearm", 2.2 * y
        limb(out, upper, (0, out_of, _SHOULDER), (0, out_of, _SHOULDER - 0.28), 0.045, 1.5, **own)
        limb(out, lower, (0, out_of, _SHOULDER - 0.28), (0, out_of, _SHOULDER - 0.55), 0.04, 0.6, **own)
        out.add_joint("six_dof", upper, "chest", name=f"{side} shoulder", anchor=(0, out_of, _SHOULDER),
                      axes=_rotations(_ARM, (-1, 1), (-2, 1), (-1, 1)))
        hand, wrist = f"{side} hand", _SHOULDER - 0.55
        out.add_body(box_shape(0.08, 0.04, 0.1), name=hand, mass=0.4, position=(0, out_of, wrist - 0.05),
                     **own)
        out.add_joint("hinge", hand, lower, name=f"{side} wrist", anchor=(0, out_of, wrist), axis=(1, 0, 0),
                      axes=[{"min": -0.8, "max": 0.8, **_ARM}])
        out.add_joint("hinge", lower, upper, name=f"{side} elbow", anchor=(0, out_of, _SHOULDER - 0.28),
                      axis=(0, 1, 0), axes=[{"min": -2.2, "max": 0, **_ARM}])
    return out


class Humanoid(Robot):
    """A robot with two legs and two arms, 17 bodies and 27 degrees of freedom: walk along x.

    Observation, 72 numbers: height of the chest [m], its orientation (4), velocity (3) [m/s], acceleration
    (3) [m/s2] and angular velocity (3) [rad/s] as an inertial sensor measures them, positions (27) [rad] and
    speeds (27) [rad/s] of the axes, normal forces on both feet over the weight (2), and the heights of pelvis
    and head [m].
    Action: targets of the 27 axes, from -1 (lower limit) over 0 (pose of the scene) to 1 (upper limit).
    Reward: speed along x [m/s] + 1 - 0.02 |action|^2. An episode ends with the chest below 0.9 m.
    """

    def __init__(self, num_envs: int = 1, **options: Any) -> None:
        self.single_observation_space, self.single_action_space = box(72), box(_FREEDOMS, -1, 1)
        super().__init__(scene(), num_envs, **{"dt": 0.005, "frame_skip": 4, "iterations": 6, **options})
        self._parts = [name for name in self.bodies if name != "ground"]
        # the translations of six-dof joints are locked
        low, high = self._limits
        self._free = np.flatnonzero(low < high)
        assert len(self._free) == _FREEDOMS
        self._weight = 9.81 * 46

    def _act(self, actions: np.ndarray, worlds: np.ndarray) -> None:
        self._drive(actions, worlds, self._free)

    def _observe(self) -> np.ndarray:
        x, feet = self.states("position"), ("left foot", "right foot")
        heights = x[:, [self.bodies[name] for name in ("pelvis", "head")], 2]
        return np.concatenate([
            x[:, self.bodies["chest"], 2:], self.states("orientation", "chest"),
            self.states("velocity", "chest"), self.sensors("acceleration", "chest"),
            self.sensors("angular_rate", "chest"), self.joints("position")[:, self._free],
            self.joints("speed")[:, self._free],
            *(self.sensors("touch", foot) / self._weight for foot in feet), heights], axis=1)

    def _reward(self, observations: np.ndarray, actions: np.ndarray) -> np.ndarray:
        return observations[:, 5] + 1 - 0.02 * (np.clip(actions, -1, 1) ** 2).sum(axis=1)

    def _terminated(self, observations: np.ndarray) -> np.ndarray:
        return observations[:, 0] < 0.9

    def _start(self, worlds: np.ndarray) -> None:
        noise = self.draw(worlds, 3)
        self._move(worlds, self._parts, np.zeros(len(worlds)), np.zeros_like(noise), 0.05 * noise)
