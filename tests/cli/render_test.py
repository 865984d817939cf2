#!/usr/bin/env python3
"""Films, pictures and plots of the real program, drawn in software. Usage: render_test.py PATH_OF_RUBBLE"""
import json
import os
import re
import shutil
import struct
import subprocess
import unittest
import xml.etree.ElementTree as xml

from drawing_case import DRAWING, ENVIRONMENT, HAS_GL, DrawingCase
from png_file import pixels, words

HAS_CAIRO = DRAWING["text"].startswith("Cairo on")
SVG, XLINK = "{http://www.w3.org/2000/svg}", "{http://www.w3.org/1999/xlink}"


class Case(DrawingCase):
    def png_size(self, name):
        with open(self.path(name), "rb") as file:
            head = file.read(24)
        self.assertEqual(head[:8], b"\x89PNG\r\n\x1a\n")
        return struct.unpack(">II", head[16:])

    def content(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()


@unittest.skipUnless(HAS_GL, "built without OpenGL")
class Layers(Case):
    """Depths, normals and light of a block of 1 m, from the front and above."""
    camera = ["--eye", "0,-6,3", "--target", "0,0,0.5", "--steps", "1", "--size", "96x54", "--samples", "1",
              "-q"]

    def render(self, *arguments):
        self.rubble("render", self.scene(2), "-o", self.path("p.png"), *self.camera, *arguments)

    def exr(self, name):
        """Channels of an OpenEXR file by name, as ffmpeg's decoder and the format's own library read it."""
        data = self.content(name)
        self.assertEqual(data[:8], b"\x76\x2f\x31\x01\x02\0\0\0")
        attributes, at = {}, 8
        while data[at]:
            key, kind = data[at:].split(b"\0", 2)[:2]
            at += len(key) + len(kind) + 2
            size, = struct.unpack_from("<i", data, at)
            attributes[key.decode()], at = data[at + 4:at + 4 + size], at + 4 + size
        self.assertEqual(attributes["compression"], b"\0")
        names = re.findall(rb"([A-Z.]+)\0\x02\0\0\0\0\0\0\0\x01\0\0\0\x01\0\0\0", attributes["channels"])
        right, bottom = struct.unpack("<4i", attributes["dataWindow"])[2:]
        width, channels = right + 1, {name.decode(): [] for name in names}
        for line, begin in enumerate(struct.unpack_from(f"<{bottom + 1}Q", data, at + 1)):
            size = 4 * width * len(names)
            self.assertEqual(struct.unpack_from("<2i", data, begin), (line, size))
            numbers = struct.unpack_from(f"<{width * len(names)}f", data, begin + 8)
            for k, channel in enumerate(channels.values()):
                channel += numbers[k * width:(k + 1) * width]
        self.assertEqual(len(data), begin + 8 + size)
        return channels

    def test_depths_of_all_formats_agree(self):
        self.render("--depth", self.path("d.npy"))
        self.render("--depth", self.path("d.png"))
        self.render("--depth", self.path("d.exr"))
        meters = struct.unpack("<5184f", self.content("d.npy")[128:])
        self.assertEqual(self.exr("d.exr"), {"Z": list(meters)})
        millimeters = [number for row in words(self.path("d.png")) for number in row]
        self.assertEqual(len(millimeters), 96 * 54)
        for near, number in zip(meters, millimeters):
            self.assertLessEqual(abs(number - min(65535, 1000 * near)), 1)
        # the middle of the picture is a point of the block before its center, which is 6.5 m away
        self.assertTrue(5500 < millimeters[27 * 96 + 48] < 6500)

    def test_normals_are_those_of_the_surfaces(self):
        self.render("--normals", self.path("n.png"))
        self.render("--normals", self.path("n.npy"))
        self.render("--normals", self.path("n.exr"))
        numbers = struct.unpack("<15552f", self.content("n.npy")[128:])
        self.assertEqual(self.exr("n.exr"),
                         {name: list(numbers[k::3]) for k, name in enumerate(("N.X", "N.Y", "N.Z"))})
        rows = words(self.path("n.png"))
        seen = {(48, 33): (0, -1, 0), (48, 21): (0, 0, 1), (5, 45): (0, 0, 1)}
        for (x, y), wanted in seen.items():
            for k, (number, expected) in enumerate(zip(rows[y][3 * x:3 * x + 3], wanted)):
                self.assertAlmostEqual(number / 32767 - 1, expected, delta=0.02)
                self.assertAlmostEqual(numbers[3 * (96 * y + x) + k], expected, delta=0.02)
        self.refused("render", self.scene(2), "-o", self.path("p.png"), "--normals", self.path("n.bmp"),
                     says=".exr")

    def test_the_sun_stands_where_it_is_put(self):
        def ground_beside(*sun):
            self.render(*sun)
            row = pixels(self.path("p.png"))[2][36]
            return sum(row[3 * 28:3 * 36]), sum(row[3 * 60:3 * 68])

        left, right = ground_beside("--sun", "0,25")  # from the right: the shadow lies at the left
        self.assertLess(1.1 * left, right)
        left, right = ground_beside("--sun", "180,25")
        self.assertLess(1.1 * right, left)

    def test_lamps_light_the_night(self):
        def ground(*options):
            self.render("--sun-strength", "0", "--sky-strength", "0.02", *options)
            row = pixels(self.path("p.png"))[2][45]
            return [sum(row[3 * at + k] for at in range(0, 96, 8)) for k in range(3)]

        night, lamp = ground(), ground("--light", "0,-2,3,30,ff0000")
        self.assertGreater(lamp[0], 2 * night[0])
        self.assertLess(lamp[2], 1.2 * night[2] + 12)
        for bad, says in (("1,2,3", "an intensity above 0"), ("0,0,1,-1", "an intensity above 0"),
                          ("0,0,1,1,red", "a color RRGGBB"), ("0,0,1e999,1", "an intensity above 0")):
            self.refused("render", self.scene(2), "-o", self.path("p.png"), "--light", bad, says=says)
        self.refused("render", self.scene(2), "-o", self.path("p.png"), "--sun-color", "red",
                     says="--sun-color")
        lamps = ["--light", "0,0,1,1"] * 17
        self.refused("render", self.scene(2), "-o", self.path("p.png"), *lamps, says="at most 16 lights")


@unittest.skipUnless(HAS_GL, "built without OpenGL")
class Render(Case):
    def test_numbered_pictures_by_time(self):
        # One second of scene at 10 pictures per second: 0, 0.1, ... 1.
        self.rubble("render", self.scene(), "-o", self.path("f_%03d.png"), "--size", "64x36", "--fps", "10", "--samples", "1", "-q")
        names = sorted(name for name in os.listdir(self.folder.name) if name.startswith("f_"))
        self.assertEqual(names, [f"f_{i:03}.png" for i in range(11)])
        self.assertEqual(self.png_size("f_010.png"), (64, 36))
        self.assertNotEqual(self.content("f_000.png"), self.content("f_005.png"))

    def test_every_and_from_count_steps(self):
        self.rubble("render", self.scene(), "-o", self.path("f_%d.png"), "--size", "64x36", "--every", "20", "--from", "20", "--samples", "1", "-q")
        self.assertEqual(sorted(n for n in os.listdir(self.folder.name) if n.startswith("f_")), ["f_0.png", "f_1.png", "f_2.png"])

    def test_a_film_shows_steps_and_what_lies_between(self):
        # At 120 pictures per second every other one is a step of 1/60 s. Those between are neither of their
        # neighbors.
        options = ["--size", "128x72", "--samples", "1", "-q"]
        self.rubble("render", self.scene(), "-o", self.path("f_%03d.png"), "--fps", "120", "--steps", "20", *options)
        self.rubble("render", self.scene(), "-o", self.path("every_%d.png"), "--every", "1", "--steps", "20", *options)
        self.rubble("render", self.scene(), "-o", self.path("end.png"), "--steps", "20", *options)
        film, steps = [self.content(f"f_{i:03}.png") for i in range(41)], [self.content(f"every_{i}.png") for i in range(21)]
        self.assertEqual(film[::2], steps)
        self.assertEqual(steps[20], self.content("end.png"))
        self.assertNotIn(film[35], [film[34], film[36]])

    def test_boxes_are_triangles_where_opengl_is_old(self):
        measure = ["render", self.scene(), "--measure", "1", "--size", "64x36"]
        asked = {**ENVIRONMENT, "RUBBLE_GL_COMPUTE": "on"}
        self.assertIn("boxes by compute", self.rubble(*measure, environment=asked).stdout)
        self.assertIn("boxes as triangles", self.rubble(*measure).stdout)
        self.assertIn("boxes as triangles", self.rubble(*measure, environment={**asked, "MESA_GL_VERSION_OVERRIDE": "4.1"}).stdout)
        self.refused(*measure, environment={**asked, "RUBBLE_GL_COMPUTE": "maybe"}, says="on or off")

    def test_the_same_run_gives_the_same_picture(self):
        for name in ["a.png", "b.png"]:
            self.rubble("render", self.scene(), "-o", self.path(name), "--steps", "10", "--size", "64x36", "--samples", "2", "-q")
        self.assertEqual(self.content("a.png"), self.content("b.png"))

    def test_a_recording_looks_like_its_run(self):
        recording = self.path("run.rubble")
        self.rubble("run", self.scene(), "-q", "--steps", "20", "--record", recording)
        self.rubble("render", recording, "-o", self.path("r.png"), "--size", "64x36", "--samples", "1", "-q")
        self.assertEqual(self.png_size("r.png"), (64, 36))

    def test_damaged_recordings_are_refused(self):
        recording = self.path("run.rubble")
        self.rubble("run", self.scene(), "-q", "--steps", "5", "--record", recording)
        with open(recording, "r+b") as file:
            file.seek(50)
            file.write(b"\xff\xff\xff")
        self.refused("render", recording, "-o", self.path("r.png"), says="checksum")
        with open(recording, "wb") as file:
            file.write(b"not a recording at all, but long enough to have been one")
        self.refused("render", recording, "-o", self.path("r.png"), says=recording)
        self.refused("render", self.path("none.rubble"), "-o", self.path("r.png"), says="none.rubble")

    def test_two_runs_side_by_side(self):
        for compare in ["1,8", "cpu,reference"]:
            self.rubble("render", self.scene(), "-o", self.path("c.png"), "--compare", compare, "--size", "164x48", "--steps", "3",
                        "--samples", "1", "--overlay", "-q")
            self.assertEqual(self.png_size("c.png"), (164, 48))
        self.refused("render", self.scene(), "-o", self.path("c.png"), "--compare", "1,2,3", says="--compare")
        self.refused("render", self.scene(), "-o", self.path("c.png"), "--compare", "cpu,abacus", says="abacus")
        self.refused("render", self.scene(), "-o", self.path("c.png"), "--compare", "1,99999999999",
                     says="--compare")

    def test_every_camera(self):
        pictures = set()
        for camera in ["scene", "front", "side", "back", "top", "corner", "low", "close"]:
            self.rubble("render", self.scene(), "-o", self.path("c.png"), "--camera", camera, "--size", "64x36", "--steps", "1",
                        "--samples", "1", "-q")
            pictures.add(self.content("c.png"))
        self.assertEqual(len(pictures), 8)
        wrong = [["--camera", "moon", "corner"],
                 ["--camera-path", self.path("none.json"), "expected a file that can be read, got none"],
                 ["--depth", "/nowhere/d.npy", "/nowhere/d.npy"],
                 ["--normals", "/nowhere/n_%04d.png", "/nowhere/n_"]]
        for option, value, says in wrong:
            done = self.refused("render", self.scene(), "-o", self.path("wrong.png"), option, value,
                                says=says)
            self.assertNotIn("step", done.stderr)
        self.assertFalse(os.path.exists(self.path("wrong.png")))

    def test_colors_and_lines_show_the_world(self):
        pictures = set()
        for option in [[], ["--color-by", "multiplier"], ["--color-by", "island"], ["--color-by", "multiplier", "--color-max", "1e9"],
                       ["--show", "contacts"], ["--show", "contacts,forces"], ["--show", "bounds"]]:
            self.rubble("render", self.scene(), "-o", self.path("c.png"), "--size", "96x54", "--steps", "20", "--samples", "1", "-q", *option)
            pictures.add(self.content("c.png"))
        self.assertEqual(len(pictures), 7)
        self.refused("render", self.scene(), "-o", self.path("c.png"), "--color-by", "taste", says="--color-by")
        self.refused("render", self.scene(), "-o", self.path("c.png"), "--show", "thoughts", says="contacts, forces, joints or bounds")

    def test_a_trajectory_has_no_forces_to_show(self):
        recording = self.path("run.rubble")
        self.rubble("run", self.scene(), "-q", "--steps", "2", "--record", recording)
        self.rubble("render", recording, "-o", self.path("r.png"), "--size", "64x36", "--samples", "1", "-q", "--color-by", "speed")
        self.refused("render", recording, "-o", self.path("r.png"), "--color-by", "multiplier", says="poses alone")
        self.refused("render", recording, "-o", self.path("r.png"), "--show", "forces", says="poses alone")

    def test_measure_can_step_before_each_frame(self):
        done = self.rubble("render", self.scene(), "--measure", "2", "--live", "--size", "64x36", "--backend", "cpu")
        self.assertIn("step: mean", done.stdout)
        self.assertIn("from the host's arrays", done.stdout)
        self.assertIn("60 frames and 30 steps take", done.stdout)
        self.refused("render", self.scene(), "-o", self.path("r.png"), "--live", says="--measure")

    def test_measure_writes_nothing(self):
        before = set(os.listdir(self.folder.name)) | {"scene.json"}
        done = self.rubble("render", self.scene(), "--measure", "2", "--size", "64x36")
        self.assertIn("frames per second", done.stdout)
        # The stages add up to what they say.
        stages = {line.split()[0]: float(line.split()[1]) for line in done.stdout.splitlines() if line.split()[2:] == ["ms"]}
        self.assertLessEqual({"poses", "view", "shadows", "bodies", "material", "occlusion", "light", "display", "sum"}, set(stages))
        self.assertAlmostEqual(sum(stages.values()), 2 * stages["sum"], delta=0.1)
        self.assertEqual(set(os.listdir(self.folder.name)), before)

    def test_bad_requests(self):
        self.refused("render", self.scene(), says="--out")
        self.refused("render", self.scene(), "-o", self.path("film.txt"), says=".mp4")
        self.refused("render", self.scene(), "-o", "/nowhere/at/all.png", "--size", "64x36", "--steps", "1", "--samples", "1", says="/nowhere")
        self.refused("render", self.scene(), "-o", self.path("%05d.png"), "--fps", "1000", "--slow", "1000",
                     "--steps", "600",
                     "--size", "64x36", says="--fps")


class Film(Case):
    def test_without_ffmpeg_it_says_so_before_it_simulates(self):
        environment = {**ENVIRONMENT, "PATH": self.folder.name}
        self.refused("render", "pile-510k", "-o", self.path("film.mp4"), says="apt-get install ffmpeg", environment=environment)
        self.assertFalse(os.path.exists(self.path("film.mp4")))

    @unittest.skipUnless(HAS_GL and shutil.which("ffmpeg"), "built without OpenGL, or no ffmpeg")
    def test_a_small_picture_of_the_end(self):
        self.rubble("render", self.scene(), "-o", self.path("end.jpg"), "--size", "65x37", "--steps", "3",
                    "--samples", "1", "-q")
        self.assertEqual(self.content("end.jpg")[:3], b"\xff\xd8\xff")

    @unittest.skipUnless(shutil.which("ffmpeg"), "no ffmpeg")
    def test_a_failure_of_ffmpeg_is_reported(self):
        self.refused("render", self.scene(), "-o", "/nowhere/film.mp4", "--size", "64x36",
                     says="expected a file that can be written")
        self.refused("render", self.scene(), "-o", self.path("film.mp4"), "--size", "65x36", says="even")

    @unittest.skipUnless(HAS_GL and shutil.which("ffmpeg"), "built without OpenGL, or no ffmpeg")
    def test_names_that_ffmpeg_could_take_for_options_addresses_or_patterns(self):
        # relative ones, since an absolute one begins with a slash
        for folder in ("-r", "pipe:1", "50%d", "%04d:-x"):
            os.mkdir(self.path(folder))
            for name, magic in (("film.mp4", b"ftyp"), ("end.jpg", b"\xff\xd8\xff"), ("film.gif", b"GIF8")):
                self.rubble("render", self.scene(), f"--out={folder}/{name}", "--size", "64x36",
                            "--steps", "3", "--samples", "1", "-q", inside=self.folder.name)
                self.assertIn(magic, self.content(f"{folder}/{name}")[:8], folder)
                self.assertEqual(os.listdir(self.path(folder)), [name])
                os.remove(self.path(f"{folder}/{name}"))
        for name in ("-y.mp4", "a:b.mp4", "100%d.mp4"):
            self.rubble("render", self.scene(), f"--out={name}", "--size", "64x36", "--steps", "3",
                        "--samples", "1", "-q", inside=self.folder.name)
            self.assertIn(b"ftyp", self.content(name)[:8], name)

    @unittest.skipUnless(HAS_GL and shutil.which("ffmpeg") and shutil.which("ffprobe"),
                         "built without OpenGL, or no ffmpeg")
    def test_a_film_has_the_right_length(self):
        # One second of scene, two times slower, at 15 pictures per second, both ends: 31 pictures.
        film = self.path("film.mp4")
        self.rubble("render", self.scene(), "-o", film, "--size", "64x36", "--fps", "15", "--slow", "2", "--samples", "1", "--overlay", "-q")
        probed = json.loads(subprocess.run(
            ["ffprobe", "-v", "error", "-count_frames", "-show_entries", "stream=width,height,nb_read_frames,avg_frame_rate", "-of", "json", film],
            capture_output=True, text=True, check=True).stdout)["streams"][0]
        self.assertEqual((probed["width"], probed["height"]), (64, 36))
        self.assertEqual(int(probed["nb_read_frames"]), 31)
        self.assertEqual(probed["avg_frame_rate"], "15/1")


def runs(root):
    """Texts as lists of glyphs, which Cairo draws by number and place."""
    found = []
    for group in root.iter(SVG + "g"):
        glyphs = [glyph.get(XLINK + "href") for glyph in group if glyph.tag == SVG + "use"]
        if glyphs and len(glyphs) == len(group):
            found.append(glyphs)
    return found


def pattern(letters):
    """Which letters are alike: the same for a text and for its glyphs."""
    return [letters.index(letter) for letter in letters]


def points(path):
    return [(float(x), float(y)) for x, y in re.findall(r"[ML] (\S+) (\S+)", path.get("d"))]


def property_of(path, name):
    """Of a path, which has it as an attribute or in its style."""
    style = dict(part.strip().split(":") for part in (path.get("style") or "").split(";") if ":" in part)
    return path.get(name) or style.get(name)


@unittest.skipUnless(HAS_CAIRO, "built without Cairo")
class Plot(Case):
    def report(self, name, *arguments):
        self.rubble("run", self.scene(), "-q", "--steps", "60", "--series", "--json", self.path(name), *arguments)
        return self.path(name)

    def changed(self, report, **values):
        with open(report, encoding="utf-8") as file:
            record = json.load(file)
        with open(report, "w", encoding="utf-8") as file:
            json.dump({**record, **values}, file)
        return report

    def plotted(self, *arguments):
        self.rubble("plot", *arguments, "-o", self.path("plot.svg"))
        return xml.fromstring(self.content("plot.svg"))

    def test_content(self):
        root = self.plotted(self.report("a.json"), self.report("b.json", "--iterations", "9"))
        patterns = [pattern(run) for run in runs(root)]
        for expected in ["Time of a settled step by stage", "Energy, kinetic and potential", "Time of a step",
                         "9 iterations", "time [s]"]:
            self.assertIn(pattern(expected), patterns, expected)
        self.assertNotIn(pattern("Penetration of joints"), patterns)
        strokes = [path for path in root.iter(SVG + "path") if property_of(path, "stroke-width") == "1.8"]
        curves = [points(path) for path in strokes]
        self.assertEqual(len(curves), 6)  # two runs: error, energy and step time
        # All of them over the same time.
        self.assertEqual(len({(curve[0][0], curve[-1][0]) for curve in curves}), 1)
        self.assertGreater(curves[0][-1][0], curves[0][0][0] + 500)
        # Energy only falls here, and down is down: y grows.
        heights = [y for _, y in curves[0]]
        self.assertGreater(len(heights), 10)
        self.assertEqual(heights, sorted(heights))
        self.assertGreater(heights[-1], heights[0] + 20)

    def test_bars_are_as_long_as_the_times(self):
        report = self.changed(self.report("a.json"), stages_ms={"primal": 6.0, "dual": 2.0})
        lengths = []
        for path in self.plotted(report, "--kind", "timing").iter(SVG + "path"):
            corners = points(path)
            if not corners:  # the glyph of a space
                continue
            left, right = min(x for x, _ in corners), max(x for x, _ in corners)
            low, high = min(y for _, y in corners), max(y for _, y in corners)
            if property_of(path, "fill") != "none" and high - low == 18:
                lengths.append(right - left)
        self.assertEqual(len(lengths), 2)
        self.assertAlmostEqual(lengths[0] / lengths[1], 3, places=2)

    def test_labels_of_any_bytes(self):
        report = self.report("a.json")
        for label, shown in [("a\x01bb\x1b\n", "a?bb??"), ("<&\">>", "<&\">>"),
                             ("\u00e9t\u00e9 \u03bb", "\u00e9t\u00e9 \u03bb")]:
            root = self.plotted(self.changed(report, label=label), "--kind", "energy")
            self.assertIn(pattern(shown), [pattern(run) for run in runs(root)])

    def test_png(self):
        self.rubble("plot", self.report("a.json"), "-o", self.path("plot.png"), "--kind", "energy")
        self.assertEqual(self.png_size("plot.png")[0], 1720)

    def test_bad_input(self):
        report = self.report("a.json")
        self.refused("plot", report, "-o", self.path("plot.bmp"), says=".svg")
        self.refused("plot", report, "-o", self.path("plot.svg"), "--kind", "pie", says="energy")
        self.refused("plot", self.scene(), "-o", self.path("plot.svg"), says="reports of run or bench")
        self.refused("plot", self.path("none.json"), "-o", self.path("plot.svg"), says="none.json")
        with open(report, "w", encoding="utf-8") as file:
            file.write("{\"scene\": ")
        self.refused("plot", report, "-o", self.path("plot.svg"), says="JSON")
        self.rubble("run", self.scene(), "-q", "--json", report)
        self.refused("plot", report, "-o", self.path("plot.svg"), "--kind", "energy", says="--series")

    def test_what_is_zero_throughout_has_no_panel(self):
        with open(self.path("floating.json"), "w", encoding="utf-8") as file:
            json.dump({"gravity": [0, 0, 0], "steps": 5,
                       "bodies": [{"shape": {"type": "sphere", "radius": 0.5}, "velocity": [1, 0, 0]}]}, file)
        self.rubble("run", self.path("floating.json"), "-q", "--series", "--json", self.path("f.json"))
        titles = [pattern(run) for run in runs(self.plotted(self.path("f.json")))]
        self.assertNotIn(pattern("Deepest contact"), titles)
        self.assertIn(pattern("Energy, kinetic and potential"), titles)
        plot = self.path("f.svg")
        record = json.loads(self.rubble("plot", self.path("f.json"), "-o", plot, "--json").stdout)
        self.assertEqual(record["files"], [{"file": plot, "bytes": os.path.getsize(plot)}])


class WithoutTheirPackages(Case):
    @unittest.skipIf(HAS_GL, "built with OpenGL")
    def test_films(self):
        self.refused("render", self.scene(), "-o", self.path("p.png"), says="libepoxy-dev")
        self.refused("render", self.scene(), "--measure", "1", says="libepoxy-dev")

    @unittest.skipIf(HAS_CAIRO, "built with Cairo")
    def test_plots(self):
        self.rubble("run", self.scene(), "-q", "--json", self.path("a.json"))
        self.refused("plot", self.path("a.json"), "-o", self.path("plot.svg"), says="libcairo2-dev")


if __name__ == "__main__":
    unittest.main(verbosity=1)
