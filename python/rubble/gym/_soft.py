"""Lifting a soft block with an arm."""
from __future__ import annotations

from typing import Any

import numpy as np

from .. import Scene, box as box_shape, capsule, plane, tet_box
from ._hand import FINGER, OPEN, ROBOT, HandEnv, add_grip, add_hand, lifting
from ._vector import box

_SHOULDER, _LENGTH = 0.3, 0.35  # height of the shoulder, length of each half of the arm [m]
_WRIST = 0.05  # over the hand [m]
_PLACE = np.array((0.4, 0, 0.3))  # of the hand at the start [m]
_BLOCK, _CELLS = np.array((0.06, 0.06, 0.075)), (4, 4, 5)  # [m]; 6 tetrahedra in each cell
#: The only deformable object of a world: its surface meets bodies alone.
_MATERIAL = {"density": 500, "youngs_modulus": 5e4, "poisson_ratio": 0.4, "material": {"friction": 1.0},
             "collide_surface": False}
_DRIVE = {"drive_stiffness": 1500, "drive_damping": 60, "max_drive_force": 80}


def _bends(places: np.ndarray) -> np.ndarray:
    """Angles (n, 4) [rad] with which the hand is upright at places (n, 3) [m]: of the turntable about z, then
    of upper arm, forearm and hand about y, each in the one before. At 0 the arm is stretched along x."""
    reach, rise = np.hypot(places[:, 0], places[:, 1]), places[:, 2] + _WRIST - _SHOULDER
    far = np.hypot(reach, rise)
    half = np.arccos(np.clip(far / (2 * _LENGTH), -1, 1))
    upper, elbow = -np.arctan2(rise, reach) - half, 2 * half
    return np.stack([np.arctan2(places[:, 1], places[:, 0]), upper, elbow, -upper - elbow], axis=1)


def _scene() -> Scene:
    out = Scene()
    out.add_body(plane(), name="ground", material={"friction": 0.8})
    out.add_body(box_shape(0.12, 0.12, 0.2), name="turntable", position=(0, 0, 0.2), mass=2, **ROBOT)
    _, upper, elbow, _ = _bends(_PLACE[None])[0]
    at, other = np.array((0, 0, _SHOULDER)), "turntable"
    joints = [("turntable", "world", (0, 0, 0), (0, 0, 1))]
    for name, angle, mass in (("upper arm", upper, 1), ("forearm", upper + elbow, 0.7)):
        along = np.array((np.cos(angle), 0, -np.sin(angle)))
        out.add_body(capsule(0.03, _LENGTH), name=name, position=at + along * _LENGTH / 2, mass=mass,
                     orientation={"axis": [0, 1, 0], "degrees": 90 + np.degrees(angle)}, **ROBOT)
        joints.append((name, other, at, (0, 1, 0)))
        at, other = at + along * _LENGTH, name
    add_hand(out, _PLACE, 1)
    joints.append(("hand", other, at, (0, 1, 0)))
    for name, other, anchor, axis in joints:
        out.add_joint("hinge", name, other, name=name + " hinge", anchor=anchor, axis=axis, axes=[_DRIVE])
    add_grip(out, _PLACE, 1)
    corner = _PLACE * (1, 1, 0) - _BLOCK * (0.5, 0.5, 0)
    out.add_deformable(tet_box(corner, _BLOCK, _CELLS), name="block", **_MATERIAL)
    return out


def _mean(vertices: Any) -> Any:
    """(n, 3) of vertices (n, m, 3), of numpy or of torch."""
    return vertices.mean(1)


def _extent(vertices: Any) -> Any:
    return np.ptp(vertices, 1) if isinstance(vertices, np.ndarray) else vertices.amax(1) - vertices.amin(1)


class LiftSoft(HandEnv):
    """Grasp a soft block of 480 tetrahedra and 0.135 kg that lies at a random place, and lift it to 0.2 m.

    Observation, 23 numbers: angles (4) [rad] and speeds (4) [rad/s] of the arm, place [m] and speed [m/s] of
    a finger, and forces of the drives of both fingers [N] over 10. Then the place (3) [m] of the hand in the
    world. Of the block: its center (3) [m] relative to the hand, its mean velocity (3) [m/s], and its extent
    (2) [m] along x and y. Action (4) and reward: as of `LiftCube`, with the center of the block.
    """

    _low = np.array((-0.15, -0.25, -_PLACE[2] + FINGER + 0.02, 0))
    _high = np.array((0.1, 0.25, 0.2, OPEN))

    def __init__(self, num_envs: int = 1, **options: Any) -> None:
        self.single_observation_space, self.single_action_space = box(23), box(4, -1, 1)
        super().__init__(_scene(), num_envs, **{"max_episode_steps": 250, **options})

    def _axes(self, targets: np.ndarray) -> np.ndarray:
        return _bends(_PLACE + targets) - _bends(_PLACE[None])

    def _observe(self) -> np.ndarray:
        angles, speeds = self.joints("position")[:, :5], self.joints("speed")[:, :5]
        grip = self.joints("drive_force")[:, 4:] / 10
        hand = self.states("position", "hand")
        center, width = self.vertices("block", of=_mean), self.vertices("block", of=_extent)[:, :2]
        moves = self.vertices("block", "velocities", _mean)
        return np.concatenate([angles[:, :4], speeds[:, :4], angles[:, 4:], speeds[:, 4:], grip, hand,
                               center - hand, moves, width], axis=1)

    def _reward(self, observations: np.ndarray, actions: np.ndarray) -> np.ndarray:
        height = observations[:, 14] + observations[:, 17] - _BLOCK[2] / 2
        return lifting(observations[:, 15:18], 10 * np.abs(observations[:, 10:12]), height)

    def _start(self, worlds: np.ndarray) -> None:
        super()._start(worlds)
        moves = np.zeros((len(worlds), 3))
        moves[:, :2] = self.draw(worlds, 2) * (0.06, 0.15)
        for world, move in zip(worlds, moves):
            block = self.worlds[world].deformables["block"]
            block.set_vertices(block.positions + move)
