"""The table of platforms in docs/determinism.md counts the rows of tests/golden.txt."""
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]


class GoldenTable(unittest.TestCase):
    def test_counts_are_those_of_the_file(self):
        rows = [line.split() for line in (ROOT / "tests/golden.txt").read_text(encoding="utf-8").splitlines()
                if line and not line.startswith("#")]
        page = (ROOT / "docs/determinism.md").read_text(encoding="utf-8")
        table = [[cell.strip() for cell in line.strip("|").split("|")] for line in page.splitlines()
                 if line.startswith("|")]
        steps = {30: 3, 300: 4}
        counted = 0
        for cells in table:
            for count, column in steps.items():
                found = re.fullmatch(r"(\d+) of (\d+)", cells[column]) if len(cells) == 5 else None
                if not found:
                    continue
                counted += 1
                recorded = sum(row[0] == "cpu" and int(row[2]) == count for row in rows)
                self.assertEqual(int(found[2]), recorded, cells)
                self.assertLessEqual(int(found[1]), recorded, cells)
        self.assertGreaterEqual(counted, 2)


if __name__ == "__main__":
    unittest.main()
