"""A robot with four legs on rough ground."""
from __future__ import annotations

from typing import Any

import numpy as np

from .. import Scene, box as box_shape, height_field
from ._random import uniform
from ._robot import Robot, limb
from ._vector import box

_HEIGHT, _THIGH, _SHIN = 0.36, 0.2, 0.2  # of the hips over the ground; lengths of a leg [m]
_BEND = 0.55  # of a thigh from upright in the pose of the scene; the shin bends back as far [rad]
_FIELD, _SPACING, _ROUGHNESS, _MARGIN = 41, 0.25, 0.06, 1.0  # samples a side; [m]
_SCAN = np.stack(np.meshgrid([-0.2, 0, 0.2, 0.4, 0.6], [-0.2, 0, 0.2], indexing="ij"), -1).reshape(-1, 2)
_TERRAIN_SEED = 1
_FREEDOMS = 12
_DRIVE = {"drive_stiffness": 80, "drive_damping": 2, "max_drive_force": 30}


def terrain() -> np.ndarray:
    """Heights [m] of smooth hills, (samples, samples). They are 0 in the middle, where a robot begins."""
    wave = uniform(_TERRAIN_SEED, np.arange(24), 0, 4, -1, 1)
    x, y = np.meshgrid(*2 * [np.arange(_FIELD) * _SPACING], indexing="xy")
    heights = sum(a * np.sin(3 * (kx * x + ky * y) + np.pi * phase) for a, kx, ky, phase in wave) / 6
    middle = (_FIELD - 1) * _SPACING / 2
    flat = np.clip((np.hypot(x - middle, y - middle) - _MARGIN / 2) / _MARGIN, 0, 1)
    return _ROUGHNESS * flat * heights


def scene() -> Scene:
    """A trunk of 9 kg on four legs with three driven hinges each, on a height field. x is forward."""
    out = Scene()
    middle = (_FIELD - 1) * _SPACING / 2
    out.add_body(height_field(terrain(), (_SPACING, _SPACING)), name="ground", motion="static",
                 position=(-middle, -middle, 0), material={"friction": 1.0})
    own = {"group": -1}  # parts of the robot do not collide with one another
    out.add_body(box_shape(0.5, 0.2, 0.12), name="trunk", position=(0, 0, _HEIGHT + 0.02), mass=9, **own)
    for front, ahead in (("front", 0.2), ("hind", -0.2)):
        for side, y in (("left", 0.1), ("right", -0.1)):
            leg, out_of = f"{front} {side}", 1.4 * y
            hip = np.array([ahead, out_of, _HEIGHT])
            knee = hip + _THIGH * np.array([-np.sin(_BEND), 0, -np.cos(_BEND)])
            foot = knee + _SHIN * np.array([np.sin(_BEND), 0, -np.cos(_BEND)])
            out.add_body(box_shape(0.06, 0.06, 0.06), name=f"{leg} hip", mass=0.4,
                         position=(ahead, y, _HEIGHT), **own)
            limb(out, f"{leg} thigh", hip.tolist(), knee.tolist(), 0.025, 0.6, **own)
            limb(out, f"{leg} shin", knee.tolist(), foot.tolist(), 0.02, 0.25, material={"friction": 1.0},
                 **own)
            out.add_joint("hinge", f"{leg} hip", "trunk", name=f"{leg} hip", anchor=(ahead, y, _HEIGHT),
                          axis=(1, 0, 0), axes=[{"min": -0.5, "max": 0.5, **_DRIVE}])
            out.add_joint("hinge", f"{leg} thigh", f"{leg} hip", name=f"{leg} thigh", anchor=hip.tolist(),
                          axis=(0, 1, 0), axes=[{"min": -1.0, "max": 1.0, **_DRIVE}])
            out.add_joint("hinge", f"{leg} shin", f"{leg} thigh", name=f"{leg} knee", anchor=knee.tolist(),
                          axis=(0, 1, 0), axes=[{"min": -1.0, "max": 0.8, **_DRIVE}])
    return out


class Quadruped(Robot):
    """A robot with four legs and twelve driven hinges on rough ground: walk along x.

    Observation, 53 numbers: orientation (4), velocity (3) [m/s], acceleration (3) [m/s2] and angular velocity
    (3) [rad/s] of the trunk as an inertial sensor measures them, positions (12) [rad] and speeds (12) [rad/s]
    of the hinges, its height over the ground below it [m], and heights of the ground at 15 places around it
    relative to that below it [m].
    Action: targets of the hinges, from -1 (lower limit) over 0 (pose of the scene) to 1 (upper limit).
    Reward: speed along x [m/s], at most 1, + 0.5 - 0.02 |action|^2. An episode ends with the trunk
    below 0.15 m over the ground, upside down or off the field.
    """

    def __init__(self, num_envs: int = 1, **options: Any) -> None:
        self.single_observation_space, self.single_action_space = box(53), box(_FREEDOMS, -1, 1)
        self._terrain = terrain()
        super().__init__(scene(), num_envs, **{"dt": 0.005, "frame_skip": 4, "iterations": 6, **options})
        self._parts = [name for name in self.bodies if name != "ground"]

    def _act(self, actions: np.ndarray, worlds: np.ndarray) -> None:
        self._drive(actions, worlds, range(_FREEDOMS))

    def _ground(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Height of the ground [m]: interpolated between samples."""
        at = np.clip(np.stack([x, y]) / _SPACING + (_FIELD - 1) / 2, 0, _FIELD - 1.001)
        (i, j), (u, v) = at.astype(int), at - np.floor(at)
        h = self._terrain
        return ((1 - v) * ((1 - u) * h[j, i] + u * h[j, i + 1])
                + v * ((1 - u) * h[j + 1, i] + u * h[j + 1, i + 1]))

    def _observe(self) -> np.ndarray:
        x, q = self.states("position", "trunk"), self.states("orientation", "trunk")
        yaw = 2 * np.arctan2(q[:, 3], q[:, 0])
        c, s = np.cos(yaw)[:, None], np.sin(yaw)[:, None]
        around = self._ground(x[:, :1] + c * _SCAN[:, 0] - s * _SCAN[:, 1],
                              x[:, 1:2] + s * _SCAN[:, 0] + c * _SCAN[:, 1])
        below = self._ground(x[:, 0], x[:, 1])[:, None]
        return np.concatenate([
            q, self.states("velocity", "trunk"), self.sensors("acceleration", "trunk"),
            self.sensors("angular_rate", "trunk"), self.joints("position"), self.joints("speed"),
            x[:, 2:] - below, around - below], axis=1)

    def _reward(self, observations: np.ndarray, actions: np.ndarray) -> np.ndarray:
        return np.minimum(observations[:, 4], 1) + 0.5 - 0.02 * (np.clip(actions, -1, 1) ** 2).sum(axis=1)

    def _terminated(self, observations: np.ndarray) -> np.ndarray:
        q = observations[:, :4]
        upright = 1 - 2 * (q[:, 1] ** 2 + q[:, 2] ** 2)
        reach = (_FIELD - 1) * _SPACING / 2 - 0.5
        far = np.abs(self.states("position", "trunk")[:, :2]).max(axis=1) > reach
        return (observations[:, 37] < 0.15) | (upright < 0.3) | far

    def _start(self, worlds: np.ndarray) -> None:
        noise = self.draw(worlds, 4)
        self._move(worlds, self._parts, 0.3 * noise[:, 0], np.zeros((len(worlds), 3)), 0.1 * noise[:, 1:])
