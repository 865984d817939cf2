"""Exports read by the libraries of their formats: OpenUSD (pip install usd-core) and NumPy. Skipped where
they are missing."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

try:
    import numpy as np
    from pxr import Usd, UsdGeom
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

RUBBLE = sys.argv.pop(1)
STEPS = 40
COUNT = 300


def scene():
    random = np.random.default_rng(4)
    bodies = [{"name": "ground", "shape": {"type": "plane"}}]
    for i in range(COUNT):
        size = [[1, 0.5, 0.4], [0.6, 0.6, 0.6]][i % 2]
        shape = {"type": "sphere", "radius": 0.3} if i % 5 == 0 else {"type": "box", "size": size}
        bodies.append({"name": f"b{i}", "shape": shape,
                       "position": [*random.uniform(-9, 9, 2).tolist(), 2 + 0.5 * i],
                       "velocity": random.normal(0, 3, 3).tolist(),
                       "angular_velocity": random.normal(0, 5, 3).tolist()})
    bodies.append({"shape": {"type": "hull", "points": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]},
                   "position": [12, 0, 3]})
    cloth = {"type": "cloth", "name": "a sheet", "triangles": [[0, 1, 2], [1, 3, 2]], "thickness": 0.01,
             "vertices": [[0, 20, 2], [1, 20, 2], [0, 21, 2], [1, 21, 2]]}
    rope = {"type": "cable", "name": "rope", "radius": 0.05, "fixed": [0],
            "vertices": [[5, 20, 3], [5.5, 20, 3], [6, 20, 3]]}
    grains = {"type": "particles", "name": "sand", "vertices": [[0, 25, 1], [0, 25, 2]], "radius": 0.1}
    late = {"name": "late", "shape": {"type": "sphere", "radius": 0.5}, "position": [30, 0, 9]}
    return {"name": "mixed \"things\"", "steps": STEPS, "bodies": bodies,
            "deformables": [cloth, rope, grains],
            "events": [{"step": 10, "add": [late]}, {"step": 20, "remove": ["b7"]}]}


def matrices(orientations, scales):
    w, x, y, z = orientations.astype(float).T
    rows = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
                     [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
                     [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)]])
    return rows.transpose(2, 0, 1) * scales[:, :, None]


class Exports(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        root = pathlib.Path(cls.folder.name)
        (root / "scene.json").write_text(json.dumps(scene()))
        cls.files = {kind: root / f"out.{kind}" for kind in ("rubble", "usda", "usdc", "npz")}
        cls.rubble("run", root / "scene.json", "-q", "-b", "cpu", "--record", cls.files["rubble"])
        for kind in ("usda", "usdc", "npz"):
            cls.rubble("export", cls.files["rubble"], "-q", "-o", cls.files[kind])
        cls.table = np.load(cls.files["npz"])
        cls.names = [name.decode() for name in cls.table["names"]]

    @staticmethod
    def rubble(*arguments):
        subprocess.run([RUBBLE, *arguments], check=True, timeout=300)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_numpy_has_all_frames(self):
        t = self.table
        self.assertEqual(t["positions"].shape, (STEPS + 1, COUNT + 3, 3))
        self.assertTrue((t["step"] == np.arange(STEPS + 1)).all())
        np.testing.assert_allclose(np.linalg.norm(t["orientations"][0, :-1], axis=1), 1, atol=1e-6)
        late, gone = self.names.index("late"), self.names.index("b7")
        there = np.isfinite(t["positions"]).all(axis=2)
        self.assertEqual((np.flatnonzero(there[:, late])[0], np.flatnonzero(there[:, gone])[-1]), (11, 20))
        self.assertTrue(there[11:, late].all() and there[:21, gone].all())
        np.testing.assert_allclose(t["velocities"][15, 3],
                                   (t["positions"][15, 3] - t["positions"][14, 3]) * 60, rtol=1e-5, atol=1e-5)
        self.assertEqual([name.decode() for name in t["deformables"]], ["a sheet", "rope", "sand"])

    def check_stage(self, kind):
        stage = Usd.Stage.Open(str(self.files[kind]))
        self.assertEqual(UsdGeom.GetStageUpAxis(stage), "Z")
        self.assertEqual(UsdGeom.GetStageMetersPerUnit(stage), 1)
        self.assertAlmostEqual(stage.GetTimeCodesPerSecond(), 60, 6)
        self.assertEqual((stage.GetStartTimeCode(), stage.GetEndTimeCode()), (0, STEPS))
        self.assertEqual(stage.GetDefaultPrim().GetPath(), "/scene")
        moving = UsdGeom.PointInstancer(stage.GetPrimAtPath("/scene/moving"))
        self.assertEqual(len(moving.GetPrototypesRel().GetTargets()), 3)
        for time in (0, 10, 11, 20, 21, STEPS):
            ids = np.array(moving.GetIdsAttr().Get(time))
            there = np.isfinite(self.table["positions"][time][:, 0])
            there[self.names.index("ground")] = False
            self.assertEqual(set(ids), set(np.flatnonzero(there)))
            got = np.array(moving.ComputeInstanceTransformsAtTime(time, time))
            np.testing.assert_allclose(got[:, 3, :3], self.table["positions"][time][ids], atol=1e-5)
            scales = np.array(moving.GetScalesAttr().Get(time))
            # Corners of bodies: half a size of 1 m at most.
            wanted = matrices(self.table["orientations"][time][ids], scales)
            np.testing.assert_allclose(got[:, :3, :3], wanted, atol=1e-5)
            coarse = np.array([[q.real, *q.imaginary] for q in moving.GetOrientationsAttr().Get(time)])
            np.testing.assert_allclose(coarse, self.table["orientations"][time][ids], atol=5e-4)
            np.testing.assert_allclose(np.array(moving.GetVelocitiesAttr().Get(time)),
                                       self.table["velocities"][time][ids], atol=1e-6)
        colors = UsdGeom.PrimvarsAPI(moving).GetPrimvar("displayColor")
        self.assertEqual(colors.GetInterpolation(), "varying")
        self.assertEqual(len(colors.Get(0)), len(moving.GetIdsAttr().Get(0)))
        self.check_deformables(stage)
        camera = UsdGeom.Camera(stage.GetPrimAtPath("/scene/camera")).GetCamera(0)
        np.testing.assert_allclose(np.linalg.det(np.array(camera.transform)), 1, atol=1e-6)
        self.assertTrue(2 < camera.GetFieldOfView(camera.FOVVertical) < 90)
        return stage

    def check_deformables(self, stage):
        firsts = self.table["first_vertices"]
        sheet = UsdGeom.Mesh(stage.GetPrimAtPath("/scene/a_sheet"))
        self.assertEqual(list(sheet.GetFaceVertexIndicesAttr().Get(0)), [0, 1, 2, 1, 3, 2])
        for time in (0, STEPS):
            at = self.table["vertices"][time]
            points = np.array(sheet.GetPointsAttr().Get(time))
            np.testing.assert_allclose(points, at[firsts[0]:firsts[1]], atol=1e-5)
            np.testing.assert_allclose(np.array(sheet.GetVelocitiesAttr().Get(time)),
                                       self.table["vertex_velocities"][time][firsts[0]:firsts[1]], atol=1e-6)
            rope = UsdGeom.BasisCurves(stage.GetPrimAtPath("/scene/rope"))
            self.assertEqual(list(rope.GetCurveVertexCountsAttr().Get(time)), [2, 2])
            points = np.array(rope.GetPointsAttr().Get(time))
            np.testing.assert_allclose(points, at[firsts[1]:firsts[2]][[0, 1, 1, 2]], atol=1e-5)
            sand = UsdGeom.Points(stage.GetPrimAtPath("/scene/sand"))
            np.testing.assert_allclose(np.array(sand.GetPointsAttr().Get(time)), at[firsts[2]:], atol=1e-5)
            self.assertAlmostEqual(sand.GetWidthsAttr().Get()[0], 0.2, 6)

    def test_usda_is_the_recording(self):
        self.check_stage("usda")

    def test_usdc_is_the_recording_and_equals_usda(self):
        binary = self.check_stage("usdc")
        text = Usd.Stage.Open(str(self.files["usda"]))
        a, b = (stage.GetRootLayer().ExportToString() for stage in (binary, text))
        self.assertEqual(a.splitlines(), b.splitlines())

    def test_prototypes_are_closed_and_have_their_size(self):
        stage = Usd.Stage.Open(str(self.files["usdc"]))
        cache = UsdGeom.BBoxCache(0, ["default"])
        sizes = {prim.GetName().rsplit("_", 1)[0]: cache.ComputeLocalBound(prim).GetRange().GetSize()
                 for prim in stage.GetPrimAtPath("/scene/moving/prototypes").GetChildren()}
        for kind, size in (("box", 2), ("sphere", 2), ("hull", 1)):
            np.testing.assert_allclose(sizes[kind], [size] * 3, rtol=0.02)


unittest.main()
