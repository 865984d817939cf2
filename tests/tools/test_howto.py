"""The code on pages is that of files that tests compile and run."""
import json
import pathlib
import re
import runpy
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BLOCK = re.compile(r"<!-- (\S+\.\w+) -->\n```\w*\n(.*?)```\n", re.S)
PART = re.compile(r"<!-- part of (\S+) -->\n```\w*\n(.*?)```\n", re.S)
# A row of the table of speeds: scene, bodies, settled and smash step [ms].
SPEED = re.compile(r"^\| `([\w-]+)`[^|]*\| ([\d,]+) \| ([\d.]+) \| ([\d.]+) \|", re.M)


def pages():
    return [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]


def records():
    for path in (ROOT / "bench" / "results").rglob("*.json"):
        data = json.loads(path.read_text(encoding="utf-8"))
        yield from data if isinstance(data, list) else [data]


class HowTo(unittest.TestCase):
    def test_pages_show_the_programs_as_they_are(self):
        shown = set()
        for page in pages():
            text = page.read_text(encoding="utf-8")
            for name, code in BLOCK.findall(text):
                if name.startswith("examples/"):
                    shown.add(name)
                    self.assertEqual(code, (ROOT / name).read_text(encoding="utf-8"), f"{page.name}: {name}")
            for name, code in PART.findall(text):
                shown.add(name)
                self.assertIn(code, (ROOT / name).read_text(encoding="utf-8"), f"{page.name}: {name}")
        programs = {f"examples/{path.name}" for path in (ROOT / "examples").glob("*.cpp")}
        self.assertLessEqual(programs, shown, "a program that no page shows")

    def test_what_a_program_prints_stands_below_its_tabs(self):
        sys.path.insert(0, str(ROOT / "tools"))
        with_tabs = runpy.run_path(str(ROOT / "tools/make_docs"))["with_tabs"]
        page = with_tabs((ROOT / "docs/tutorial.md").read_text(encoding="utf-8"))
        for mark, indented in (("part of", True), ("run", True), ("prints", False)):
            lines = re.findall(rf"^( *)<!-- {mark}\b[^\n]*\n( *)```", page, re.M)
            self.assertGreater(len(lines), 2, mark)
            self.assertEqual({bool(blanks) for line in lines for blanks in line}, {indented}, mark)

    def test_the_game_is_short(self):
        game = (ROOT / "examples" / "wall_game.cpp").read_text(encoding="utf-8")
        self.assertLess(len(game.splitlines()), 150)

    def test_speeds_of_the_readme_are_those_of_records(self):
        rows = SPEED.findall((ROOT / "README.md").read_text(encoding="utf-8"))
        self.assertGreater(len(rows), 5)
        known = [r for r in records() if isinstance(r.get("settled_ms"), dict)]
        for scene, bodies, settled, smash in rows:
            def near(record, name, text):
                found = (record.get(name) or {}).get("mean")
                digits = len(text.partition(".")[2])
                return found is not None and abs(found - float(text)) <= 0.51 * 10 ** -digits
            self.assertTrue(any(r["scene"] == scene and r["bodies"] == int(bodies.replace(",", ""))
                                and near(r, "settled_ms", settled) and near(r, "smash_ms", smash)
                                for r in known),
                            f"{scene}: {settled} and {smash} ms are in no record")


if __name__ == "__main__":
    unittest.main()
