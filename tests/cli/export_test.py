"""`rubble export`: what its files hold, read without a library of theirs; torn recordings; going on."""
import csv
import json
import os
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import unittest

RUBBLE = sys.argv.pop(1)
STEPS = 30

SCENE = {
    "name": "boxes and a sheet",
    "bodies": [
        {"name": "ground", "shape": {"type": "plane"}},
        {"name": "crate", "shape": {"type": "box", "size": [1, 0.5, 0.5]}, "position": [0, 0, 5],
         "velocity": [2, 0, 0], "angular_velocity": [0, 0, 1]},
        {"name": "post", "shape": {"type": "cylinder", "radius": 0.2, "length": 2}, "position": [3, 0, 1],
         "motion": "static"}],
    "deformables": [
        {"type": "cloth", "name": "sheet", "vertices": [[0, 3, 2], [1, 3, 2], [0, 4, 2], [1, 4, 2]],
         "triangles": [[0, 1, 2], [1, 3, 2]], "thickness": 0.01}],
    "events": [{"step": 10, "add": [{"name": "ball", "shape": {"type": "sphere", "radius": 0.3},
                                     "position": [-3, 0, 4], "velocity": [0, 1, 0]}]}],
    "steps": STEPS}


class Export(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.scene, cls.recording = cls.path("scene.json"), cls.path("run.rubble")
        pathlib.Path(cls.scene).write_text(json.dumps(SCENE))
        cls.rubble("run", cls.scene, "-q", "-b", "cpu", "--record", cls.recording)
        cls.rubble("export", cls.recording, "-q", "-o", cls.path("all.csv"))

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder.name, name)

    @staticmethod
    def rubble(*arguments, status=0):
        done = subprocess.run([RUBBLE, *map(str, arguments)], capture_output=True, text=True, timeout=300)
        if done.returncode != status:
            raise AssertionError(f"{arguments}: {done.returncode}\n{done.stdout}{done.stderr}")
        return done

    def rows(self, name="all.csv"):
        with open(self.path(name), newline="") as file:
            return list(csv.DictReader(file))

    def of(self, name, frame):
        return next(r for r in self.rows() if r["object"] == name and int(r["frame"]) == frame)

    def test_csv_has_every_body_and_vertex_of_every_frame(self):
        rows = self.rows()
        count = sum(3 + (frame > 10) + 4 for frame in range(STEPS + 1))
        self.assertEqual(len(rows), count)
        crate = self.of("crate", STEPS)
        self.assertAlmostEqual(float(crate["x"]), 2 * STEPS / 60, 4)
        self.assertAlmostEqual(float(crate["vx"]), 2, 2)
        self.assertAlmostEqual(float(crate["vz"]), -9.81 * STEPS / 60, 1)
        self.assertEqual({r["vertex"] for r in rows if r["object"] == "sheet"}, {"0", "1", "2", "3"})

    def test_a_scene_is_run_and_exported_at_once(self):
        self.rubble("export", self.scene, "-q", "-b", "cpu", "-o", self.path("direct.csv"))
        self.assertEqual(self.rows("direct.csv"), self.rows())

    def test_pictures_have_the_parts_of_a_look_and_tables_its_body(self):
        ball = {"type": "sphere", "radius": 0.5}
        scene = {"name": "look", "gravity": [0, 0, 0], "steps": 2,
                 "bodies": [{"name": "crate", "shape": {"type": "box", "size": [1, 1, 1]},
                             "position": [0, 0, 5], "orientation": {"axis": [0, 1, 0], "degrees": 90}}],
                 "looks": [{"body": "crate", "parts": [
                     {"shape": ball, "position": [0, 0, 2], "color": [1, 0, 0]}, {"color": [0, 0, 1]}]},
                     {"body": "world", "parts": [{"shape": ball, "position": [7, 0, 0]}]}]}
        file = self.path("look.json")
        pathlib.Path(file).write_text(json.dumps(scene))
        for name in ("look.usda", "look.csv"):
            self.rubble("export", file, "-q", "-b", "cpu", "-o", self.path(name))
        text = pathlib.Path(self.path("look.usda")).read_text()
        self.assertRegex(text, r"displayColor = \[\(1, 0, 0\), \(0, 0, 1\)\]")
        moving = text[text.index('"moving"'):text.index('"still"')]
        first = re.search(r"positions.timeSamples = \{\s*0: \[\(([^)]*)\), \(([^)]*)\)\]", moving)
        for found, expected in zip(first.groups(), ([2, 0, 5], [0, 0, 5])):
            for number, wanted in zip(found.split(","), expected):
                self.assertAlmostEqual(float(number), wanted, 4)
        self.assertIn("(7, 0, 0)", text[text.index('"still"'):])
        self.assertEqual({r["object"] for r in self.rows("look.csv")}, {"crate"})

    def test_frames_can_be_chosen(self):
        self.rubble("export", self.recording, "-q", "-o", self.path("some.csv"), "--from", 4, "--to", 20,
                    "--every", 8)
        self.assertEqual({(r["frame"], r["step"]) for r in self.rows("some.csv")},
                         {("0", "4"), ("1", "12"), ("2", "20")})
        done = self.rubble("export", self.recording, "-o", self.path("x.csv"), "--to", STEPS + 1, status=2)
        self.assertIn(f"frames 0 to {STEPS}", done.stderr)

    def test_csv_goes_on_where_it_was_cut_off(self):
        whole = pathlib.Path(self.path("all.csv")).read_bytes()
        cut = pathlib.Path(self.path("cut.csv"))
        for share in (0.1, 0.5, 0.97):
            cut.write_bytes(whole[:int(share * len(whole))])
            done = self.rubble("export", self.recording, "-o", cut, "--resume")
            self.assertIn("were there", done.stdout)
            self.assertEqual(cut.read_bytes(), whole)

    def test_obj_sequences_go_on(self):
        pattern = self.path("frame_%03d.obj")
        done = self.rubble("export", self.recording, "-o", pattern, "--to", 5)
        self.assertIn("planes", done.stderr)
        self.rubble("export", self.recording, "-o", pattern, "--to", 5, "--strict", status=1)
        first = pathlib.Path(self.path("frame_000.obj"))
        content = first.read_text()
        self.assertEqual(re.findall(r"^o (.*)", content, re.M), ["crate", "post", "sheet"])
        xs = [float(v.split()[1]) for v in content.splitlines() if v.startswith("v ")][:8]
        self.assertAlmostEqual(max(xs) - min(xs), 1, 5)
        first.write_text("kept")
        os.remove(self.path("frame_004.obj"))
        self.rubble("export", self.recording, "-q", "-o", pattern, "--to", 5, "--resume")
        self.assertEqual(first.read_text(), "kept")
        self.assertTrue(os.path.exists(self.path("frame_004.obj")))

    def test_one_obj_is_the_last_frame(self):
        self.rubble("export", self.recording, "-q", "-o", self.path("last.obj"))
        content = pathlib.Path(self.path("last.obj")).read_text()
        xs = [float(v.split()[1]) for v in content.splitlines() if v.startswith("v ")][:8]
        self.assertAlmostEqual(sum(xs) / 8, float(self.of("crate", STEPS)["x"]), 4)

    def glb(self, *options):
        file = self.path("out.glb")
        done = self.rubble("export", self.recording, "-q", "-o", file, *options)
        data = pathlib.Path(file).read_bytes()
        magic, version, size, length, kind = struct.unpack_from("<4sIII4s", data)
        self.assertEqual((magic, version, size, kind), (b"glTF", 2, len(data), b"JSON"))
        binary = data[20 + length:]
        self.assertEqual(struct.unpack_from("<I4s", binary), (len(binary) - 8, b"BIN\0"))
        return json.loads(data[20:20 + length]), binary[8:], done

    def test_glb_has_a_track_for_each_moving_body(self):
        gltf, binary, done = self.glb()
        self.assertIn("1 deformable objects are left out", done.stderr)
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}
        size = {5125: 4, 5126: 4}

        def values(number):
            a = gltf["accessors"][number]
            view = gltf["bufferViews"][a["bufferView"]]
            at, count = view["byteOffset"] + a["byteOffset"], a["count"] * width[a["type"]]
            self.assertLessEqual(a["byteOffset"] + count * size[a["componentType"]], view["byteLength"])
            return struct.unpack_from(f"<{count}{'f' if a['componentType'] == 5126 else 'I'}", binary, at)

        for number in range(len(gltf["accessors"])):
            values(number)
        animation = gltf["animations"][0]
        tracks = {}
        for c in animation["channels"]:
            node = gltf["nodes"][c["target"]["node"]]
            tracks[node["name"], c["target"]["path"]] = animation["samplers"][c["sampler"]]
        poses = {(b, p) for b in ("crate", "ball") for p in ("translation", "rotation")}
        self.assertEqual(set(tracks), poses | {("ball", "scale")})
        places = values(tracks["crate", "translation"]["output"])
        times = values(tracks["crate", "translation"]["input"])
        self.assertEqual(len(times), STEPS + 1)
        self.assertAlmostEqual(times[-1], STEPS / 60, 5)
        for frame in (0, 15, STEPS):
            row = self.of("crate", frame)
            for k, axis in enumerate("xyz"):
                self.assertAlmostEqual(places[3 * frame + k], float(row[axis]), 5)
        # The ball has no size before it comes.
        shown = tracks["ball", "scale"]
        self.assertEqual(shown["interpolation"], "STEP")
        self.assertEqual([round(60 * t) for t in values(shown["input"])], [0, 11])
        self.assertEqual(values(shown["output"])[:3], (0, 0, 0))
        self.assertAlmostEqual(values(shown["output"])[3], 0.3, 6)

    def test_a_torn_recording_says_what_is_there_and_gives_it(self):
        scene = dict(SCENE, steps=100)
        pathlib.Path(self.path("long.json")).write_text(json.dumps(scene))
        torn = self.path("torn.rubble")
        self.rubble("run", self.path("long.json"), "-q", "-b", "cpu", "--record", torn)
        data = pathlib.Path(torn).read_bytes()
        pathlib.Path(torn).write_bytes(data[:len(data) * 6 // 10])
        done = self.rubble("export", torn, "-o", self.path("torn.csv"))
        said = re.search(r"cut off; (\d+) frames .* in ([\d.]+) of ([\d.]+) MB", done.stderr)
        frames, there, whole = said.groups()
        self.assertEqual({int(r["frame"]) for r in self.rows("torn.csv")}, set(range(int(frames))))
        self.assertGreater(int(frames), 10)
        self.assertLessEqual(float(there), float(whole))

    def test_a_recording_has_one_ending(self):
        for name in ("x.csv", "x.usda", "x"):
            done = self.rubble("run", self.scene, "-q", "--record", self.path(name), status=2)
            self.assertIn("rubble export", done.stderr)
            self.assertFalse(os.path.exists(self.path(name)))

    def test_unknown_formats_and_missing_files_are_refused(self):
        done = self.rubble("export", self.recording, "-o", self.path("x.abc"), status=2)
        self.assertIn(".usdc", done.stderr)
        self.rubble("export", self.path("none.rubble"), "-o", self.path("x.csv"), status=2)
        self.rubble("export", self.recording, "-o", "/nowhere/at/all.usdc", status=2)


unittest.main()
