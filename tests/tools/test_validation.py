"""Claims about tools/make_validation: a run that is cut off loses no row, and goes on from there. Motion and
forces at rest are compared with those of another engine."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

TOOLS = pathlib.Path(__file__).resolve().parents[2] / "tools"
TOOL = TOOLS / "make_validation"
sys.dont_write_bytecode = True
sys.path.insert(0, str(TOOLS))
import validation_engines  # noqa: E402
import validation_pages  # noqa: E402

BOOK = {"iterations": [], "steps_per_second": [], "chapters": [{"title": "One", "entries": [
    {"scene": scene, "metric": "error", "kind": "closed form", "target": 0, "says": ""}
    for scene in ("first", "second", "third")]}]}
# Says each run in the file `runs`, and first does what the file of the scene's name says.
PROGRAM = """#!/bin/sh
here=$(dirname "$0")
echo "$2" >>"$here/runs"
[ -e "$here/$2" ] && . "$here/$2"
echo '{"device": "d", "commit": "c", "iterations": 4, "dt": 0.1,
       "verdict": {"claims": [{"metric": "error", "value": VALUE, "min": null, "max": 1}]}}'
"""


class Validation(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        (self.root / "tools").mkdir()
        (self.root / "tools/validation.json").write_text(json.dumps(BOOK))
        self.make_program(0)

    def make_program(self, value):
        self.program = self.root / "rubble"
        self.program.write_text(PROGRAM.replace("VALUE", str(value)))
        self.program.chmod(0o755)

    def measure(self, *options):
        """Exit status, scenes that ran, and standard error."""
        runs = self.root / "runs"
        runs.write_text("")
        done = subprocess.run([sys.executable, "-B", TOOL, "--root", self.root, self.program, "--no-pages",
                               *options], capture_output=True, text=True)
        return done.returncode, runs.read_text().split(), done.stderr

    def results(self):
        file = self.root / "docs/validation/results/cpu.json"
        return json.loads(file.read_text())["runs"] if file.exists() else {}

    def test_goes_on_where_it_was_killed(self):
        (self.root / "third").write_text("kill -9 $PPID")
        status, runs, _ = self.measure()
        self.assertEqual((status, runs, self.results()), (-9, ["first", "second", "third"], {}))
        (self.root / "third").unlink()
        status, runs, says = self.measure()
        # the first one says what build this is
        self.assertEqual((status, runs, len(self.results())), (0, ["first", "third"], 3), says)
        self.assertIn("1 of 1 runs, 0 s left", says)

    def test_stops_at_a_limit(self):
        (self.root / "second").write_text("exec sleep 600")
        status, runs, says = self.measure("--limit", "10")
        self.assertEqual((status, runs), (1, ["first", "second"]))
        self.assertIn("2 of 3 runs are left, 0 of them failed", says)
        (self.root / "second").unlink()
        self.assertEqual(self.measure("--jobs", "2")[0], 0)
        self.assertEqual(len(self.results()), 3)

    def test_a_line_that_was_cut_off_is_measured_again(self):
        self.measure()
        journal = self.root / "out/validation/cpu.jsonl"
        journal.write_text(journal.read_text()[:-9])
        status, runs, _ = self.measure()
        self.assertEqual((status, runs), (0, ["first", "third"]))

    def test_another_program_begins_anew(self):
        self.measure()
        self.make_program(0.5)
        status, runs, _ = self.measure()
        self.assertEqual((status, len(runs)), (0, 3))
        self.assertEqual({run["claims"]["error"][0] for run in self.results().values()}, {0.5})

    def test_a_run_that_fails_leaves_the_others(self):
        (self.root / "second").write_text("echo no such scene >&2; exit 2")
        status, runs, says = self.measure("--jobs", "2")
        self.assertEqual((status, sorted(runs)), (1, ["first", "second", "third"]))
        self.assertIn("no such scene", says)
        self.assertIn("1 of 3 runs are left, 1 of them failed", says)

    def test_measures_what_is_missing(self):
        self.measure("--scene", "second")
        status, runs, says = self.measure("--missing")
        self.assertEqual((status, runs, len(self.results())), (0, ["first", "third"], 3), says)
        self.assertEqual(self.measure("--missing")[1], [])


class Engines(unittest.TestCase):
    RATE = 20  # so that every second step is compared

    def test_motion_is_compared_at_all_moments(self):
        entry, known = {"size": 2}, {"seconds": 0.2, "readings": {"bob": [[1, 0], [2, 0]]}}
        own = [[0, 0], [0.5, 0], [1, 0], [1.5, 0], [2, 0.1]]
        self.assertAlmostEqual(validation_engines.error(entry, known, {"bob": own}, self.RATE), 0.05)
        self.assertAlmostEqual(validation_engines.error(entry, known, {"bob": own[1:]}, self.RATE), 0.05,
                               msg="a table may begin after the first step")
        own[2] = [float("nan"), 0]
        self.assertEqual(validation_engines.error(entry, known, {"bob": own}, self.RATE), float("inf"))

    def test_forces_are_the_mean_of_the_last_moment(self):
        known = {"seconds": 0.2, "readings": {"foot": [[0], [10]], "hand": [[0], [-20]]}}
        own = {"foot": [[0], [0], [9], [12]], "hand": [[0], [0], [-20], [-20]]}
        self.assertAlmostEqual(validation_engines.error({}, known, own, self.RATE), 0.5 / 20)

    def test_bounds_of_an_entry_come_before_those_of_the_scene(self):
        figures = validation_pages.Figures.__new__(validation_pages.Figures)
        entry = {"scene": "fall", "metric": "error", "at_most": 2}
        figures.runs = {validation_pages.key_of(entry, 0, 0): {"claims": {"error": [3, 1, 5]}}}
        self.assertEqual(figures.claim(entry), [3, 1, 2])
        self.assertFalse(validation_pages.is_inside(figures.claim(entry)))


if __name__ == "__main__":
    unittest.main()
