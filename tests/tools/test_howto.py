"""The code on how-to pages is that of the files that tests compile and run."""
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BLOCK = re.compile(r"<!-- (\S+\.\w+) -->\n```\w*\n(.*?)```\n", re.S)


class HowTo(unittest.TestCase):
    def test_pages_show_the_programs_as_they_are(self):
        shown = set()
        for page in sorted((ROOT / "docs" / "howto").glob("*.md")):
            for name, code in BLOCK.findall(page.read_text(encoding="utf-8")):
                if name.startswith("examples/"):
                    shown.add(name)
                    self.assertEqual(code, (ROOT / name).read_text(encoding="utf-8"), f"{page.name}: {name}")
        self.assertEqual(shown, {f"examples/{path.name}" for path in (ROOT / "examples").glob("*.cpp")})

    def test_the_game_is_short(self):
        game = (ROOT / "examples" / "wall_game.cpp").read_text(encoding="utf-8")
        self.assertLess(len(game.splitlines()), 150)


if __name__ == "__main__":
    unittest.main()
