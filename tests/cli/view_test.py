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

from png_file import pixels

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
# A block hangs on a hinge; the hinge is in the middle of the window.
HINGED = {
    "name": "hinged", "steps": 60,
    "bodies": [{"name": "plate", "shape": {"type": "box", "size": [1, 0.2, 1]}, "position": [0, 0, 0]}],
    "joints": [{"name": "axle", "type": "hinge", "body_a": "plate", "body_b": "world", "anchor_a": [0, 0, 0], "anchor_b": [0, 0, 0]}],
}
# A sheet that is held along one side, seen from the front.
SHEET = {
    "name": "sheet", "steps": 60, "bodies": [],
    "deformables": [{"type": "cloth", "name": "sheet", "fixed": [2, 3],
                     "vertices": [[-1, 0, -1], [1, 0, -1], [-1, 0, 1], [1, 0, 1]], "triangles": [[0, 1, 3], [0, 3, 2]]}],
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
        self.state_file = self.path("state.json")

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def scene(self, content):
        with open(self.path(content["name"] + ".json"), "w", encoding="utf-8") as file:
            json.dump(content, file)
        return self.path(content["name"] + ".json")

    def open(self, scene, *arguments):
        self.window = subprocess.Popen([RUBBLE, "view", scene, "--size", "960x400", "--threads", "1", "--backend", "cpu",
                                        "--state", self.state_file, "--screenshot", self.path("last.png"), *arguments],
                                       env=self.environment, stderr=subprocess.PIPE, text=True)
        self.addCleanup(self.end)
        self.frames(2)
        self.input("search", "--sync", "--name", "Rubble", "windowfocus")
        self.frames(2)

    def close(self):
        """Closes the window; its last picture."""
        self.input("key", "ctrl+q")
        self.assertEqual(self.window.wait(timeout=PATIENCE), 0)
        return pixels(self.path("last.png"))

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

    def mouse(self, x, y):
        self.input("mousemove", str(x), str(y))
        self.frames(2)

    def click(self):
        self.input("mousedown", "1")
        self.frames(2)
        self.input("mouseup", "1")
        return self.frames(3)

    def test_keys(self):
        self.open(self.scene(SCENE))
        self.assertFalse(self.state()["paused"])
        paused = self.key("space")
        self.assertTrue(paused["paused"])
        self.assertEqual(self.frames(3)["steps"], paused["steps"])
        self.assertEqual(self.key("n")["steps"], paused["steps"] + 1)
        self.assertLess(self.key("minus")["speed"], 1)
        self.assertTrue(self.key("question")["help"])
        self.assertFalse(self.key("question")["help"])
        self.assertEqual(self.key("b", "b")["shots"], 2)
        self.assertEqual(self.key("r")["steps"], 0)
        # The mouse turns and zooms the camera.
        before = self.state()["eye"]
        self.mouse(700, 300)
        self.input("mousedown", "3")
        self.frames(3)
        self.mouse(760, 300)
        self.input("mouseup", "3")
        turned = self.frames(3)["eye"]
        self.assertGreater(sum((a - b) ** 2 for a, b in zip(before, turned)) ** 0.5, 0.3)
        self.assertAlmostEqual(turned[2], before[2], places=6)
        self.input("click", "4")
        self.assertLess(self.frames(3)["eye"][2], turned[2] - 0.1)
        self.assertEqual(self.key("f")["eye"], before, "everything, as at the beginning")
        width, height, rows = self.close()
        self.assertEqual((width, height), (960, 400))
        # The block is warm, the ground behind it grey, the panel in the corner nearly white.
        block, ground, panel = (rows[y][3 * x:3 * x + 3] for x, y in [(480, 200), (900, 200), (250, 18)])
        self.assertGreater(block[0], block[2] + 25)
        self.assertLess(abs(ground[0] - ground[2]), 25)
        self.assertGreater(min(panel), 215)

    def test_the_mouse_selects_and_pulls_a_body_and_the_past_branches(self):
        # The block is all there is to frame: it stands in the middle of the window.
        self.open(self.scene(SCENE))
        self.mouse(480, 200)
        self.input("mousedown", "1")
        self.assertTrue(self.frames(3)["held"])
        self.input("mouseup", "1")
        state = self.frames(3)
        self.assertEqual((state["selected"], state["held"]), ("block", False))
        before = state["bodies"]["block"]
        self.input("mousedown", "1")
        for y in range(180, 10, -40):
            self.mouse(480, y)
        lifted = before[2]
        for _ in range(20):
            lifted = max(lifted, self.frames(3)["bodies"]["block"][2])
            if lifted > before[2] + 0.2:
                break
        self.input("mouseup", "1")
        self.assertFalse(self.frames(3)["held"])
        self.assertGreater(lifted, before[2] + 0.2, "it was lifted")
        # Back to where it stood, step by step and in one go, and forward to the same state.
        end = self.key("space")
        self.assertEqual(self.key("Left")["steps"], end["steps"] - 1)
        self.assertEqual(self.key("Right")["hash"], end["hash"])
        start = self.key("Home")
        self.assertEqual((start["steps"], start["bodies"]["block"]), (0, [0, 0, 0.5]))
        self.assertEqual(self.key("End")["hash"], end["hash"])
        # The slider at the bottom, by the mouse.
        self.mouse(480, 362)
        middle = self.click()
        self.assertGreater(middle["steps"], 0.3 * end["last"])
        self.assertLess(middle["steps"], 0.7 * end["last"])
        self.assertEqual((middle["branches"], middle["held"]), (1, False))
        # What is done there begins a branch.
        self.mouse(480, 300)
        branched = self.key("x", "n")
        self.assertEqual((branched["branches"], branched["branch"], branched["dropped"]), (2, "branch 1", 1))
        self.assertEqual(branched["last"], middle["steps"] + 1)

    def test_a_joint_is_selected_and_all_overlays_colors_and_panels_are_drawn(self):
        self.open(self.scene(HINGED))
        self.key("space")
        self.assertEqual(self.key("j")["selected_joint"], "axle")
        self.assertEqual(self.key("Escape")["selected_joint"], "")
        self.assertEqual(self.key("1", "2", "3", "4")["overlays"], ["contacts", "forces", "joints", "bounds"])
        self.mouse(480, 200)
        self.assertEqual(self.click()["selected_joint"], "axle")
        seen = [self.key("c")["color_by"] for _ in range(9)]
        self.assertEqual(seen, ["material", "speed", "island", "color", "error", "multiplier", "stiffness", "strain", "body"])
        self.assertEqual(self.key("shift+c")["color_by"], "strain")
        state = self.key("g", "t", "n", "n", "n")
        self.assertEqual((state["plots"], state["settings"], state["message"]), (True, True, ""))
        self.assertGreaterEqual(state["plotted_steps"], 3)
        self.assertEqual(state["plotted_iterations"], state["iterations"])
        self.key("g", "t", "Escape")
        _, _, rows = self.close()
        # The x axis of the hinge's frame is red, the box about the plate blue.
        colors = [tuple(row[i:i + 3]) for row in rows[60:340] for i in range(3 * 380, 3 * 540, 3)]
        self.assertGreater(sum(r > 150 and g < 90 and b < 90 for r, g, b in colors), 20)
        self.assertGreater(sum(b > r + 70 and b > g + 30 for r, g, b in colors), 100)

    def test_the_mouse_pulls_a_vertex(self):
        self.open(self.scene(SHEET))
        corner = None
        # The lower edge is somewhere in the lower half: the sheet is all there is to frame.
        for y in range(320, 200, -20):
            self.mouse(480, y)
            self.input("mousedown", "1")
            if self.frames(3)["held"]:
                corner = y
                break
            self.input("mouseup", "1")
            self.frames(3)
        self.assertIsNotNone(corner, "the sheet is in the window")
        before = self.state()["objects"]["0"][0][2]
        for k in range(1, 8):
            self.mouse(480, corner - 20 * k)
        lifted = before
        for _ in range(30):
            state = self.frames(3)
            lifted = max(lifted, state["objects"]["0"][1][0] - state["objects"]["0"][0][0], state["objects"]["0"][0][2])
            if state["objects"]["0"][0][2] > before + 0.05:
                break
        self.input("mouseup", "1")
        self.assertGreater(state["objects"]["0"][0][2], before + 0.05, "its lower edge was lifted")
        self.assertFalse(self.frames(3)["held"])

    def test_the_picker_opens_what_is_searched_for(self):
        self.open(self.scene(SCENE))
        self.key("p")
        self.input("type", "--delay", "60", "freefall")
        self.frames(4)
        time.sleep(0.2)  # a scene is drawn after it has been looked at for a moment
        self.assertGreater(self.frames(4)["thumbnails"], 0)
        self.assertEqual(self.key("Return")["scene"], "free-fall")
        self.assertNotEqual(self.key("Next")["scene"], "free-fall")
        self.assertEqual(self.key("Prior")["scene"], "free-fall")

    def drop(self, *files):
        subprocess.run([sys.executable, "-B", os.path.join(os.path.dirname(os.path.abspath(__file__)), "xdnd_source.py"), "Rubble", *files],
                       env=self.environment, check=True, timeout=PATIENCE)
        return self.frames(3)

    def test_a_file_that_is_dropped_on_the_window_is_opened(self):
        self.open("free-fall")
        state = self.drop(self.scene({**SCENE, "name": "a scene, dropped"}))
        self.assertEqual((os.path.basename(state["scene"]), state["message"]), ("a scene, dropped.json", ""))
        self.assertEqual(sorted(state["bodies"]), ["block", "ground"])
        # What is no scene is said, and the present one stays.
        with open(self.path("notes.json"), "w", encoding="utf-8") as file:
            file.write("{ these are notes")
        state = self.drop(self.path("notes.json"))
        self.assertIn("notes.json", state["message"])
        self.assertEqual((os.path.basename(state["scene"]), sorted(state["bodies"])), ("a scene, dropped.json", ["block", "ground"]))
        # Of several the first is taken; a trajectory is one too.
        recording = self.path("run.rubble")
        subprocess.run([RUBBLE, "run", self.scene(HINGED), "-q", "--steps", "5", "--record", recording, "--backend", "cpu"], check=True,
                       stdout=subprocess.DEVNULL)
        state = self.drop(recording, self.scene(SHEET))
        self.assertEqual((state["recording"], state["last"], state["message"]), (True, 5, ""))

    def test_two_runs_side_by_side(self):
        self.open(self.scene(SCENE), "--compare", "1,8")
        state = self.key("space")
        self.assertEqual((state["sides"], state["iterations"]), (2, 1))
        _, _, rows = self.close()
        # A line between the two, and a block in the middle of the right half; the left one is behind the panel.
        self.assertGreater(min(rows[390][3 * 480:3 * 481]), 240)
        self.assertGreater(rows[200][3 * 720], rows[200][3 * 720 + 2] + 25)

    def test_a_recording_is_scrubbed(self):
        recording = self.path("run.rubble")
        subprocess.run([RUBBLE, "run", self.scene(SCENE), "-q", "--steps", "40", "--record", recording, "--backend", "cpu"], check=True,
                       stdout=subprocess.DEVNULL)
        self.open(recording)
        state = self.key("space", "End")
        self.assertEqual((state["recording"], state["steps"], state["last"]), (True, 40, 40))
        self.assertEqual(self.key("Left")["steps"], 39)
        self.assertEqual(self.key("Home")["steps"], 0)
        self.assertEqual([self.key("c")["color_by"] for _ in range(2)], ["speed", "body"])

    def test_a_damaged_recording_is_refused(self):
        with open(self.path("bad.rubble"), "wb") as file:
            file.write(b"not a recording at all, but long enough to have been one")
        done = subprocess.run([RUBBLE, "view", file.name], env=self.environment, capture_output=True, text=True, timeout=PATIENCE)
        self.assertEqual(done.returncode, 2)
        self.assertIn("bad.rubble", done.stderr)


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
