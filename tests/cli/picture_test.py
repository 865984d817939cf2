#!/usr/bin/env python3
"""Single pictures of the real program, drawn in software. Usage: picture_test.py PATH_OF_RUBBLE

RUBBLE_UPDATE_PICTURES=1 stores the brightness of pictures anew: look at the pictures before you commit it."""
import json
import os
import unittest

from drawing_case import HAS_GL, DrawingCase
from png_file import pixels

STORED = os.path.join(os.path.dirname(os.path.abspath(__file__)), "pictures.json")
BLOCK = 10  # pixels
TOLERANCE = 6  # of 255, of the mean of a block: what another version of the driver may differ by


def blocks(file):
    """Mean brightness of blocks of pixels, row by row."""
    width, height, rows = pixels(file)

    def brightness(x, y):
        red, green, blue = rows[y][3 * x:3 * x + 3]
        return 0.30 * red + 0.59 * green + 0.11 * blue

    return [[round(sum(brightness(x + i, y + j) for i in range(BLOCK) for j in range(BLOCK)) / BLOCK**2)
             for x in range(0, width - BLOCK + 1, BLOCK)] for y in range(0, height - BLOCK + 1, BLOCK)]


def largest_difference(a, b):
    return max(abs(x - y) for one, other in zip(a, b) for x, y in zip(one, other))


class Case(DrawingCase):
    def picture(self, *arguments, size="160x90"):
        """Blocks of brightness of a picture."""
        self.rubble("picture", *arguments, "-o", self.path("p.png"), "--size", size, "-q")
        return blocks(self.path("p.png"))


@unittest.skipUnless(HAS_GL, "built without OpenGL")
class Picture(Case):
    def test_scenes_look_as_stored(self):
        scenes = ["pyramid", "cloth-sphere", "ragdoll"]
        found = {scene: self.picture(scene) for scene in scenes}
        if os.environ.get("RUBBLE_UPDATE_PICTURES"):
            with open(STORED, "w", encoding="utf-8") as file:
                rows = {scene: ",\n".join("  " + json.dumps(row) for row in found[scene]) for scene in scenes}
                file.write("{\n" + ",\n".join(f' "{scene}": [\n{rows[scene]}]' for scene in scenes) + "\n}\n")
        with open(STORED, encoding="utf-8") as file:
            stored = json.load(file)
        for scene in scenes:
            self.assertLessEqual(largest_difference(found[scene], stored[scene]), TOLERANCE, scene)
        # Other scenes are told apart, and so is a camera that sees a degree more.
        self.assertGreater(largest_difference(found["pyramid"], stored["ragdoll"]), 5 * TOLERANCE)
        wider = self.picture("pyramid", "--fov", "35")
        self.assertGreater(largest_difference(wider, stored["pyramid"]), 2 * TOLERANCE)

    def test_the_subject_is_in_view(self):
        camera = ["--eye", "0,-12,2", "--target", "0,0,2", "--fov", "50"]
        empty, block, all_of_it = [self.picture(self.scene(bodies), *camera) for bodies in (1, 2, 3)]

        def differs(a, b):
            return {(x, y) for y in range(9) for x in range(16) if abs(a[y][x] - b[y][x]) > TOLERANCE}

        # 8 pixels per metre: the block stands about column 8 and row 5, the ball hangs 2 m to its right.
        self.assertIn((8, 5), differs(block, empty))
        self.assertNotIn((3, 5), differs(block, empty))
        ball = differs(all_of_it, block)
        self.assertIn((9, 3), ball)
        self.assertNotIn((6, 3), ball)

    def test_walls_that_hide_what_moves_are_left_out(self):
        camera = ["--eye", "0,-12,2", "--target", "0,0,2", "--fov", "50"]
        wall = {"motion": "static", "shape": {"type": "box", "size": [8, 0.2, 8]}}
        pictures = [self.picture(self.scene(extra=walls), *camera)
                    for walls in ([], [{**wall, "position": [0, -4, 4]}], [{**wall, "position": [0, 4, 4]}])]
        self.assertLessEqual(largest_difference(pictures[0], pictures[1]), 1)
        self.assertGreater(largest_difference(pictures[0], pictures[2]), 2 * TOLERANCE)

    def test_after_steps(self):
        start, later = self.picture(self.scene()), self.picture(self.scene(), "--at", "30")
        self.assertGreater(largest_difference(start, later), 2 * TOLERANCE)
        self.assertEqual(later, self.picture(self.scene(), "--steps", "30"))
        self.assertEqual(start, self.picture(self.scene(), "--at", "0"))

    def test_of_a_run_and_of_its_trajectory(self):
        trajectory = self.path("run.rubble")
        self.rubble("run", self.scene(), "-q", "--record", trajectory, "--picture", self.path("p.png"),
                    "--at", "0,30", "--size", "80x50")
        start, later = [blocks(self.path(name)) for name in ("p-000000.png", "p-000030.png")]
        self.assertEqual((len(start), len(start[0])), (5, 8))
        self.assertGreater(largest_difference(start, later), 2 * TOLERANCE)
        # The same camera on a trajectory, of which steps are counted alike.
        camera = ["--eye", "0,-12,2", "--target", "0,0,2"]
        played, run = [self.picture(source, "--at", "30", *camera) for source in (trajectory, self.scene())]
        self.assertLessEqual(largest_difference(played, run), 1)
        self.assertEqual(self.picture(trajectory, *camera), self.picture(trajectory, "--at", "60", *camera))
        self.refused("picture", trajectory, "-o", self.path("t.png"), "--at", "61", says="at most")
        with open(trajectory, "r+b") as file:
            file.seek(50)
            file.write(b"\xff\xff\xff")
        self.refused("picture", trajectory, "-o", self.path("t.png"), says="checksum")

    def test_colors_show_values(self):
        def color(*arguments):
            """Mean of the middle of the picture, which the block fills."""
            self.rubble("picture", *arguments, "--eye", "0,-4,0.5", "--target", "0,0,0.5",
                        "-o", self.path("c.png"), "--size", "64x36", "-q")
            return pixels(self.path("c.png"))[2][18][96:99]

        trajectory = self.path("run.rubble")
        self.rubble("run", self.scene(), "-q", "--steps", "20", "--record", trajectory)
        cold = color(trajectory, "--color-by", "speed")
        self.assertGreater(cold[2], cold[0] + 20)  # it rests
        own = color(self.scene(), "--at", "20")
        loaded = color(self.scene(), "--at", "20", "--color-by", "multiplier")
        self.assertGreater(own[0], own[2])
        self.assertGreater(loaded[0], 2 * loaded[2])  # nothing carries more than the block
        self.refused("picture", trajectory, "-o", self.path("t.png"), "--color-by", "multiplier",
                     says="poses alone")

    def test_files_of_other_kinds(self):
        for arguments in (["picture", self.scene(), "-o"], ["run", self.scene(), "--picture"]):
            self.refused(*arguments, self.path("p.bmp"), says=".png or .jpg")
        self.refused("picture", self.scene(), "-o", "/nowhere/at/all.png", says="/nowhere")


class WithoutTheRenderer(Case):
    @unittest.skipIf(HAS_GL, "built with OpenGL")
    def test_says_which_packages_are_missing(self):
        for arguments in (["picture", self.scene(), "-o"], ["run", self.scene(), "--picture"]):
            self.refused(*arguments, self.path("p.png"),
                         says="libepoxy-dev libegl-dev libgl1-mesa-dri libpng-dev")


if __name__ == "__main__":
    unittest.main(verbosity=1)
