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
