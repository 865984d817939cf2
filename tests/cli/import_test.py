"""`rubble import` and `rubble run` of models."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

RUBBLE = sys.argv.pop(1)
MODELS = pathlib.Path(__file__).resolve().parents[1] / "convert" / "models"


def rubble(*arguments):
    return subprocess.run([RUBBLE, *map(str, arguments)], capture_output=True, text=True, timeout=300)


@unittest.skipIf("pugixml" in rubble("import", MODELS / "pendulum.xml").stderr, "a build without pugixml")
class Import(unittest.TestCase):
    def test_a_model_becomes_a_scene_that_is_good(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = pathlib.Path(folder) / "arm.json"
            done = rubble("import", MODELS / "arm.xml", "-o", scene)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("motor 'grip' -> motor of joint 'grip'", done.stdout)
            self.assertEqual(rubble("check", scene).returncode, 0)

    def test_the_report_is_json_if_wanted(self):
        done = rubble("import", MODELS / "user_law.xml", "-q", "--json", "-")
        report = json.loads(done.stdout)
        self.assertEqual(report["format"], "MJCF")
        self.assertFalse(report["exact"])
        note = next(note for note in report["notes"] if note["what"] == "general 'grip'")
        self.assertEqual((note["effect"], note["file"]), ("lost", "user_law.xml"))

    def test_strict_refuses_what_is_not_exact(self):
        held = rubble("import", MODELS / "user_law.xml", "--strict")
        self.assertEqual(held.returncode, 2)
        self.assertEqual(rubble("import", MODELS / "pendulum.xml", "--strict").returncode, 0)

    def test_models_run_as_scenes_do(self):
        for name in ("pendulum.xml", "arm.urdf"):
            done = rubble("run", MODELS / name, "--steps", 10, "-q")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn(name, done.stderr)

    def test_controls_are_given_by_the_names_of_actuators(self):
        def drop_after(control):
            with tempfile.TemporaryDirectory() as folder:
                report = pathlib.Path(folder) / "report.json"
                done = rubble("run", MODELS / "rotors.xml", "--steps", 50, "-q", "--json", report,
                              "--control", f"left={control}", "--control", f"right={control}")
                self.assertEqual(done.returncode, 0, done.stderr)
                return json.loads(report.read_text())["top_drop_m"]
        self.assertLess(drop_after(8), drop_after(0) - .01)
        for wrong in ("nobody=1", "left", "left=", "left=x"):
            done = rubble("run", MODELS / "rotors.xml", "--steps", 1, "--control", wrong)
            self.assertEqual(done.returncode, 2, wrong)
            self.assertIn("--control", done.stderr)

    def test_an_import_may_run_at_once(self):
        done = rubble("import", MODELS / "arm.xml", "-q", "--key", "reach", "--run", "--steps", 10)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_what_is_wrong_is_told_with_its_place(self):
        done = rubble("import", MODELS / "arm.xml", "--key", "nowhere")
        self.assertEqual(done.returncode, 2)
        self.assertIn("--key", done.stderr)


unittest.main()
