"""A robot with four legs."""
from __future__ import annotations

from typing import Any

import numpy as np

from .. import Scene, plane, sphere
from ._robot import Robot, limb
from ._vector import box

_HEIGHT, _LEGS = 0.55, 4
_HIP, _ANKLE = 0.6, 0.6  # [rad]
_STIFFNESS, _DAMPING, _TORQUE = 60.0, 1.5, 40.0  # [N m/rad], [N m s/rad], [N m]


def scene() -> Scene:
    """A torso of 2 kg on four legs of two capsules each, with a hip about z and an ankle across the leg."""
    out = Scene()
    out.add_body(plane(), name="ground", material={"friction": 1.0})
    out.add_body(sphere(0.25), name="torso", position=(0, 0, _HEIGHT), mass=2)
    for k in range(_LEGS):
        angle = np.pi / 4 + k * np.pi / 2
        out_of = np.array([np.cos(angle), np.sin(angle), 0])
        across = np.array([-np.sin(angle), np.cos(angle), 0])
        top = np.array([0, 0, _HEIGHT])
        hip, ankle = top + 0.2 * out_of, top + 0.5 * out_of
        foot = ankle + 0.3 * out_of - np.array([0, 0, _HEIGHT - 0.08])
        limb(out, f"thigh{k}", hip, ankle, 0.07, 0.3)
        limb(out, f"shin{k}", ankle, foot, 0.07, 0.3, material={"friction": 1.0})
        drive = {"drive_stiffness": _STIFFNESS, "drive_damping": _DAMPING, "max_drive_force": _TORQUE}
        out.add_joint("hinge", f"thigh{k}", "torso", name=f"hip{k}", anchor=hip.tolist(), axis=(0, 0, 1),
                      axes=[{"min": -_HIP, "max": _HIP, **drive}])
        out.add_joint("hinge", f"shin{k}", f"thigh{k}", name=f"ankle{k}", anchor=ankle.tolist(),
                      axis=across.tolist(), axes=[{"min": -_ANKLE, "max": _ANKLE, **drive}])
    return out


class Ant(Robot):
    """A robot with four legs and eight driven hinges: walk along x.

    Observation, 28 numbers: height of the torso [m], its orientation (4), velocity (3) [m/s] and angular
    velocity (3) [rad/s], positions (8) [rad] and speeds (8) [rad/s] of the hinges, and the sum of the normal
    forces on the torso over the weight of the ant.
    Action: targets of the hinges, from -1 (lower limit) over 0 (pose of the scene) to 1 (upper limit).
    Reward: speed along x [m/s] + 0.5 - 0.05 |action|^2. An episode ends with the torso below
    0.3 m or above 1.2 m.
    """

    def __init__(self, num_envs: int = 1, **options: Any) -> None:
        self.single_observation_space, self.single_action_space = box(28), box(2 * _LEGS, -1, 1)
        super().__init__(scene(), num_envs, **{"dt": 0.01, "frame_skip": 2, "iterations": 6, **options})
        self._parts = [name for name in self.bodies if name != "ground"]
        self._weight = 9.81 * (2 + 0.6 * _LEGS)

    def _act(self, actions: np.ndarray, worlds: np.ndarray) -> None:
        self._drive(actions, worlds, range(2 * _LEGS))

    def _observe(self) -> np.ndarray:
        touch = self.sensors("touch", "torso") / self._weight
        return np.concatenate([
            self.states("position", "torso")[:, 2:], self.states("orientation", "torso"),
            self.states("velocity", "torso"), self.states("angular_velocity", "torso"),
            self.joints("position"), self.joints("speed"), touch], axis=1)

    def _reward(self, observations: np.ndarray, actions: np.ndarray) -> np.ndarray:
        return observations[:, 5] + 0.5 - 0.05 * (np.clip(actions, -1, 1) ** 2).sum(axis=1)

    def _terminated(self, observations: np.ndarray) -> np.ndarray:
        return (observations[:, 0] < 0.3) | (observations[:, 0] > 1.2)

    def _start(self, worlds: np.ndarray) -> None:
        noise = self.draw(worlds, 4)
        velocity = 0.1 * noise[:, 1:]
        self._move(worlds, self._parts, np.pi * noise[:, 0], np.zeros_like(velocity), velocity)
