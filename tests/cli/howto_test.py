#!/usr/bin/env python3
"""Runs the commands of pages as they stand there. Usage: howto_test.py PATH_OF_RUBBLE

A block after `<!-- run -->` is commands, after `<!-- run 1 -->` one that ends with status 1, and after
the name of
a file its content."""
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import unittest

from png_file import pixels

RUBBLE = os.path.abspath(sys.argv.pop(1)) if len(sys.argv) > 1 else "rubble"
DOCS = pathlib.Path(__file__).resolve().parents[2] / "docs"
BLOCK = re.compile(r"<!-- ([\w.]+(?: \d)?) -->\n```\w*\n(.*?)```\n", re.S)
DRAWS = json.loads(subprocess.run([RUBBLE, "info", "build", "--json"], capture_output=True, text=True,
                                  check=True).stdout)["drawing"]["pictures"].startswith("on")


class Case(unittest.TestCase):
    def run_page(self, name, folder):
        """Writes the files of a page and runs its commands, in the order in which they stand there."""
        for what, text in BLOCK.findall((DOCS / name).read_text(encoding="utf-8")):
            kind, _, status = what.partition(" ")
            if kind != "run":
                if "." in kind:
                    pathlib.Path(folder, kind).write_text(text, encoding="utf-8")
                continue
            for line in text.replace("\\\n", " ").splitlines():
                words = shlex.split(line, comments=True)
                self.assertEqual(words[0], "rubble")
                done = subprocess.run([RUBBLE, *words[1:]], cwd=folder, capture_output=True, text=True,
                                      timeout=600)
                self.assertEqual(done.returncode, int(status or 0), line + done.stderr)


@unittest.skipUnless(DRAWS, "this build draws no pictures")
class Pages(Case):
    def test_the_tutorial_works(self):
        with tempfile.TemporaryDirectory() as folder:
            self.run_page("tutorial.md", folder)
            self.assertEqual(pathlib.Path(folder, "ball.png").read_bytes()[:4], b"\x89PNG")

    def test_the_film_works(self):
        with tempfile.TemporaryDirectory() as folder:
            self.run_page("howto/film.md", folder)
            pictures = sorted(os.listdir(folder))
            self.assertEqual(sum(name.startswith("flight_") for name in pictures), 16)
            first, last = (pixels(os.path.join(folder, f"flight_{frame}.png")) for frame in ("0000", "0015"))
            self.assertNotEqual(first, last, "the camera moves")
            depth = pathlib.Path(folder, "depth.npy").read_bytes()
            self.assertTrue(depth.startswith(b"\x93NUMPY") and b"(180, 320)" in depth[:128])
            self.assertEqual(len(depth), 128 + 4 * 180 * 320)
            white = pathlib.Path(folder, "cut.png").read_bytes()
            self.assertEqual(white[25], 6, "red, green, blue and alpha")


if __name__ == "__main__":
    unittest.main()
