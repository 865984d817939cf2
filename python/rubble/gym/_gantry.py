"""A hand on a gantry, for environments that carry things."""
from __future__ import annotations

from typing import Sequence

import numpy as np

from .. import Scene, box, plane
from ._hand import FINGER, OPEN, ROBOT, HandEnv, add_grip, add_hand

HAND_HEIGHT, REACH = 0.3, 0.4  #: of the hand: height [m], and way from the middle along x and y [m]
_DRIVE = {"drive_stiffness": 8000, "drive_damping": 250, "max_drive_force": 200}
_RAILS = (("bridge", "world", (1, 0, 0)), ("trolley", "bridge", (0, 1, 0)), ("hand", "trolley", (0, 0, 1)))


def scene() -> Scene:
    """A ground, and a hand with two fingers that moves along x, y and z."""
    out, place = Scene(), (0, 0, HAND_HEIGHT)
    out.add_body(plane(), name="ground", material={"friction": 0.8})
    out.add_body(box(0.1, 0.1, 0.05), name="bridge", position=(0, 0, 0.9), mass=2, **ROBOT)
    out.add_body(box(0.1, 0.1, 0.05), name="trolley", position=(0, 0, 0.8), mass=1, **ROBOT)
    add_hand(out, place, 0)
    for k, (name, other, axis) in enumerate(_RAILS):
        out.add_joint("slider", name, other, name=name + " rail", anchor=place, axis=axis,
                      axes=[{"min": Gantry._low[k], "max": Gantry._high[k], **_DRIVE}])
    add_grip(out, place, 0)
    return out


class Gantry(HandEnv):
    """Moves a hand on three sliders. Actions (4): see `HandEnv`."""

    _low = np.array((-REACH, -REACH, -HAND_HEIGHT + FINGER + 0.02, 0))
    _high = np.array((REACH, REACH, 0.3, OPEN))

    def _axes(self, targets: np.ndarray) -> np.ndarray:
        return targets

    def _hand(self) -> np.ndarray:
        """10 numbers: place [m] and speed [m/s] of the hand and of the first finger, and the normal forces on
        both fingers [N] over 10."""
        x, v = self.joints("position"), self.joints("speed")
        touch = [self.sensors("touch", name) / 10 for name in ("left", "right")]
        return np.concatenate([x[:, :4], v[:, :4], *touch], axis=1)

    def _put(self, worlds: np.ndarray, bodies: Sequence[str], places: np.ndarray) -> None:
        """Puts bodies at places (n, bodies, 3) [m]."""
        self.set_states("position", worlds, bodies, places)
