"""Claims about tools/gpu_sanitize, with a compute-sanitizer that only looks at what it is given."""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

TOOL = pathlib.Path(__file__).resolve().parents[2] / "tools/gpu_sanitize"
SCENES = [{"name": name, "steps": 300, "test_steps": steps, "test_arguments": arguments}
          for name, steps, arguments in (("tower", 0, {"levels": 3}), ("pile", 5, {}), ("net", 0, {}))]
# Does what the file of the scene's name says, and notes what it was called with.
SANITIZER = """#!/bin/sh
here=$(dirname "$0")
echo "$*" >>"$here/calls"
for word in "$@"; do [ -e "$here/$word.sh" ] && . "$here/$word.sh"; done
exit 0
"""


class GpuSanitize(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        self.plant("compute-sanitizer", SANITIZER)
        self.plant("scenes.json", json.dumps(SCENES))
        self.plant("rubble", f"#!/bin/sh\ncat '{self.root / 'scenes.json'}'\n")

    def plant(self, name, text):
        (self.root / name).write_text(text)
        (self.root / name).chmod(0o755)

    def run_tool(self, *options):
        """Exit status, {run: what came of it}, calls of the sanitizer."""
        (self.root / "calls").write_text("")
        out = self.root / "out"
        done = subprocess.run([sys.executable, "-B", TOOL, out, "--build", self.root, *options], text=True,
                              env={**os.environ, "PATH": f"{self.root}:{os.environ['PATH']}"},
                              capture_output=True)
        self.assertEqual(done.stderr, "")
        rows = [line.split(maxsplit=4) for line in (out / "summary.txt").read_text().splitlines()]
        calls = (self.root / "calls").read_text().splitlines()
        return done.returncode, {f"{row[0]} {row[1]}": row[4] for row in rows}, calls

    def test_runs_every_scene_at_test_size(self):
        status, runs, calls = self.run_tool("--tool", "memcheck", "--tool", "racecheck", "--jobs", "3")
        self.assertEqual(status, 0)
        self.assertEqual(set(runs), {*(f"{tool} {scene['name']}" for tool in ("memcheck", "racecheck")
                                       for scene in SCENES), "memcheck smash", "memcheck soak"})
        self.assertEqual(set(runs.values()), {"ok"})
        for words in ("memcheck .* tower .*--steps 20 .*levels=3", "memcheck .* pile .*--steps 5 ",
                      "racecheck .* pile .*--steps 2 "):
            self.assertEqual(sum(bool(re.search(words, call)) for call in calls), 1, words)

    def test_tells_errors_crashes_and_runs_that_take_too_long(self):
        self.plant("tower.sh", "exit 99")
        self.plant("pile.sh", "exit 3")
        self.plant("net.sh", "sleep 600")
        status, runs, _ = self.run_tool("--tool", "memcheck", "--limit", "10", "--jobs", "5")
        self.assertEqual(status, 1)
        self.assertEqual(runs, {"memcheck tower": "ERRORS", "memcheck pile": "rc 3",
                                "memcheck net": "cut off", "memcheck smash": "ok", "memcheck soak": "ok"})

    def test_a_verdict_that_does_not_hold_yet_is_no_error(self):
        self.plant("tower.sh", "exit 1")
        self.assertEqual(self.run_tool("--tool", "memcheck", "--scene", "tower"),
                         (0, {"memcheck tower": "ok"}, unittest.mock.ANY))

    def test_parts_are_the_whole(self):
        parts = [set(self.run_tool("--tool", "memcheck", "--part", f"{k}/2")[1]) for k in (1, 2)]
        self.assertEqual(parts, [{"memcheck tower", "memcheck net", "memcheck smash", "memcheck soak"},
                                 {"memcheck pile"}])


if __name__ == "__main__":
    unittest.main()
