"""What tests of drawn pictures share: the program from the command line, a scene, and a folder for each test."""
import json
import os
import subprocess
import sys
import tempfile
import unittest

RUBBLE = os.path.abspath(sys.argv.pop(1)) if len(sys.argv) > 1 else "rubble"
ENVIRONMENT = {**os.environ, "RUBBLE_GL": "software"}
DRAWING = json.loads(subprocess.check_output([RUBBLE, "info", "build", "--json"]))["drawing"]
HAS_GL = DRAWING["pictures"].startswith("on")

# A ball falls beside a block that stands.
SCENE = {
    "name": "falling ball", "steps": 60,
    "bodies": [
        {"name": "ground", "motion": "static", "shape": {"type": "plane"}},
        {"name": "block", "shape": {"type": "box", "size": [1, 1, 1]}, "position": [0, 0, 0.5]},
        {"name": "ball", "shape": {"type": "sphere", "radius": 0.5}, "position": [2, 0, 3]},
    ],
}


class DrawingCase(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def scene(self, bodies=3, extra=()):
        with open(self.path("scene.json"), "w", encoding="utf-8") as file:
            json.dump({**SCENE, "bodies": [*SCENE["bodies"][:bodies], *extra]}, file)
        return self.path("scene.json")

    def rubble(self, *arguments, status=0, environment=None, inside=None):
        done = subprocess.run([RUBBLE, *arguments], capture_output=True, text=True, timeout=600,
                              env=environment or ENVIRONMENT, cwd=inside)
        self.assertEqual(done.returncode, status, f"{arguments}\n{done.stdout}\n{done.stderr}")
        return done

    def refused(self, *arguments, says, environment=None):
        done = self.rubble(*arguments, status=2, environment=environment)
        self.assertIn(says, done.stderr)
        return done
