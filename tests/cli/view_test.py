#!/usr/bin/env python3
"""Drives the window with keys and the mouse on a display of its own. Usage: view_test.py PATH_OF_RUBBLE

The window writes what it shows in every frame, and each input waits for frames: how fast the machine is decides nothing."""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

RUBBLE = os.path.abspath(sys.argv.pop(1)) if len(sys.argv) > 1 else "rubble"
HAS_VIEWER = "one without" not in subprocess.run([RUBBLE, "view", "pile-1k", "--frames", "1"], capture_output=True, text=True,
                                                 env={k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}).stderr
HAS_DISPLAY = shutil.which("Xvfb") and shutil.which("xdotool")
PATIENCE = 120  # seconds until a frame that does not come is a failure

SCENE = {
    "name": "block", "steps": 60,
    "bodies": [
        {"name": "ground", "motion": "static", "shape": {"type": "plane"}},
        {"name": "block", "shape": {"type": "box", "size": [1, 1, 1]}, "position": [0, 0, 0.5]},
    ],
}


@unittest.skipUnless(HAS_VIEWER and HAS_DISPLAY, "needs a build with the viewer, Xvfb and xdotool")
class Window(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        read, write = os.pipe()
        cls.server = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "1024x768x24"], pass_fds=[write],
                                      stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as answer:
            cls.environment = {**os.environ, "DISPLAY": ":" + answer.readline().strip(), "LIBGL_ALWAYS_SOFTWARE": "1"}
        cls.environment.pop("WAYLAND_DISPLAY", None)

    @classmethod
    def tearDownClass(cls):
        cls.server.terminate()
        cls.server.wait()

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.state_file = os.path.join(self.folder.name, "state.json")
        scene = os.path.join(self.folder.name, "block.json")
        with open(scene, "w", encoding="utf-8") as file:
            json.dump(SCENE, file)
        self.window = subprocess.Popen([RUBBLE, "view", scene, "--size", "960x600", "--threads", "1", "--state", self.state_file,
                                        "--screenshot", os.path.join(self.folder.name, "last.png")],
                                       env=self.environment, stderr=subprocess.PIPE, text=True)
        self.addCleanup(self.end)
        self.frames(2)
        self.input("search", "--sync", "--name", "Rubble", "windowfocus")
        self.frames(2)

    def end(self):
        if self.window.poll() is None:
            self.window.kill()
        self.window.communicate()

    def input(self, *arguments):
        subprocess.run(["xdotool", *arguments], env=self.environment, check=True, stdout=subprocess.DEVNULL, timeout=PATIENCE)

    def state(self):
        try:
            with open(self.state_file, encoding="utf-8") as file:
                return json.load(file)
        except FileNotFoundError:
            return {"frame": 0}

    def frames(self, count):
        """What the window shows so many frames from now."""
        return self.until(self.state()["frame"] + count)

    def until(self, frame):
        deadline = time.monotonic() + PATIENCE
        while time.monotonic() < deadline:
            state = self.state()
            if state["frame"] >= frame:
                return state
            self.assertIsNone(self.window.poll(), "the window is gone")
            time.sleep(0.02)
        self.fail("no frame comes")

    def key(self, *names):
        for name in names:
            self.input("key", name)
            self.frames(3)
        return self.state()

    def test_keys(self):
        self.assertFalse(self.state()["paused"])
        paused = self.key("space")
        self.assertTrue(paused["paused"])
        self.assertEqual(self.frames(3)["steps"], paused["steps"])
        self.assertEqual(self.key("n")["steps"], paused["steps"] + 1)
        self.assertEqual(self.key("c")["color_by"], "speed")
        self.assertLess(self.key("minus")["speed"], 1)
        self.assertTrue(self.key("question")["help"])
        self.assertEqual(self.key("b")["shots"], 1)
        self.assertEqual(self.key("r")["steps"], 0)
        self.input("key", "ctrl+q")
        self.assertEqual(self.window.wait(timeout=PATIENCE), 0)
        self.assertGreater(os.path.getsize(os.path.join(self.folder.name, "last.png")), 1000)

    def test_the_mouse_selects_and_pulls_a_body(self):
        # The block is all there is to frame: it stands in the middle of the window.
        self.input("mousemove", "480", "300")
        self.frames(3)
        self.input("mousedown", "1")
        self.assertTrue(self.frames(3)["held"])
        self.input("mouseup", "1")
        state = self.frames(3)
        self.assertEqual((state["selected"], state["held"]), ("block", False))
        before = state["bodies"]["block"]
        self.input("mousedown", "1")
        self.frames(3)
        for y in range(280, 120, -20):
            self.input("mousemove", "480", str(y))
            self.frames(2)
        lifted = before[2]
        for _ in range(20):
            lifted = max(lifted, self.frames(2)["bodies"]["block"][2])
        self.input("mouseup", "1")
        self.assertFalse(self.frames(3)["held"])
        self.assertGreater(lifted, before[2] + 0.2, "it was lifted")

    def test_the_mouse_turns_and_zooms_the_camera(self):
        before = self.key("space")["eye"]
        self.input("mousemove", "700", "500")
        self.frames(3)
        self.input("mousedown", "3")
        self.frames(3)
        self.input("mousemove", "760", "500")
        self.frames(3)
        self.input("mouseup", "3")
        turned = self.frames(3)["eye"]
        self.assertGreater(sum((a - b) ** 2 for a, b in zip(before, turned)) ** 0.5, 0.3)
        self.assertAlmostEqual(turned[2], before[2], places=6)
        self.input("click", "4")
        self.assertLess(self.frames(3)["eye"][2], turned[2] - 0.1)

    def test_the_picker_opens_what_is_searched_for(self):
        self.key("p")
        self.input("type", "--delay", "60", "freefall")
        self.frames(4)
        self.assertEqual(self.key("Return")["scene"], "free-fall")
        self.assertNotEqual(self.key("Next")["scene"], "free-fall")
        self.assertEqual(self.key("Prior")["scene"], "free-fall")


@unittest.skipUnless(HAS_VIEWER, "built without the viewer")
class NoDisplay(unittest.TestCase):
    def test_it_says_so(self):
        environment = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
        done = subprocess.run([RUBBLE, "view", "pile-1k"], capture_output=True, text=True, env=environment, timeout=PATIENCE)
        self.assertEqual(done.returncode, 2)
        self.assertIn("a display", done.stderr)
        self.assertIn("rubble render", done.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=1)
