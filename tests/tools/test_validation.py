"""Claims about tools/make_validation: a run that is cut off loses no row, and goes on from there."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

TOOL = pathlib.Path(__file__).resolve().parents[2] / "tools/make_validation"
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


if __name__ == "__main__":
    unittest.main()
