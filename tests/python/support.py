"""Shared by the tests of the Python package. They are skipped (status 77) where numpy is missing."""
import sys
import unittest

try:
    import numpy as np
except ImportError:
    print("skipped: numpy is missing")
    sys.exit(77)

import rubble


def crate_scene(**fields):
    """A ground and a crate of 1 m, 2 kg, that starts 2 m up."""
    scene = rubble.Scene()
    scene.add_body(rubble.plane(), name="ground")
    given = {"name": "crate", "mass": 2, "position": (0, 0, 2), **fields}
    scene.add_body(rubble.box(1, 1, 1), **given)
    return scene


def crate_world(**options):
    return rubble.World(crate_scene(), threads=1, **options)


def lift(way, held):
    """Actions of a hand that goes over a thing, down to it, closes and rises.

    `way` (n, 3): from the hand to where it is to grasp [m]; `held` (n,).
    """
    above = np.abs(way[:, :2]).max(axis=1) > 0.008
    grasp = ~above & (np.abs(way[:, 2]) < 0.012)
    action = np.clip(20 * np.concatenate([way, np.zeros((len(way), 1))], axis=1), -1, 1)
    action[above, 2], action[:, 3] = 0, np.where(grasp, 1, -1)
    action[held] = (0, 0, 0.5, 1)
    return action


def lift_cubes(env, steps):
    """Lifts the cubes of a "lift-cube" environment and returns their heights (n,) [m]."""
    observations, _ = env.reset(seed=4)
    for _ in range(steps):
        held = (observations[:, 8:10] > 0.1).all(axis=1)
        action = lift(observations[:, 10:13] + (0, 0, 0.02 + 0.07 / 2), held)
        observations, *_ = env.step(action)
    return env.states("position", "cube")[:, 2]


class Case(unittest.TestCase):
    def assertNear(self, found, wanted, tolerance=1e-9):
        np.testing.assert_allclose(found, wanted, rtol=0, atol=tolerance)

    def assertInvalid(self, path, call):
        """The call raises an error about that field."""
        with self.assertRaises(rubble.Error) as caught:
            call()
        self.assertEqual(caught.exception.path, path, str(caught.exception))
        return caught.exception


main = unittest.main
