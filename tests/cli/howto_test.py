#!/usr/bin/env python3
"""Runs the commands of docs/howto/film.md as they stand there. Usage: howto_test.py PATH_OF_RUBBLE"""
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
PAGE = pathlib.Path(__file__).resolve().parents[2] / "docs" / "howto" / "film.md"
BLOCK = re.compile(r"<!-- (\S+) -->\n```\w*\n(.*?)```\n", re.S)
DRAWS = json.loads(subprocess.run([RUBBLE, "info", "build", "--json"], capture_output=True, text=True,
                                  check=True).stdout)["drawing"]["pictures"].startswith("on")


@unittest.skipUnless(DRAWS, "this build draws no pictures")
class Film(unittest.TestCase):
    def test_the_page_works(self):
        with tempfile.TemporaryDirectory() as folder:
            for name, text in BLOCK.findall(PAGE.read_text(encoding="utf-8")):
                if name != "run":
                    pathlib.Path(folder, name).write_text(text, encoding="utf-8")
                    continue
                words = shlex.split(text)
                self.assertEqual(words[0], "rubble")
                done = subprocess.run([RUBBLE, *words[1:]], cwd=folder, capture_output=True, text=True,
                                      timeout=600)
                self.assertEqual(done.returncode, 0, done.stderr)
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
