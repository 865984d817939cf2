"""What docs/determinism.md claims of recorded hashes is what tests/golden.txt has."""
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
STEPS = (30, 300)


def recorded(platform, steps=None):
    """Number of hashes, after so many steps or after any number."""
    rows = [line.split() for line in (ROOT / "tests/golden.txt").read_text(encoding="utf-8").splitlines()
            if line and not line.startswith("#")]
    return sum(row[0] == platform and steps in (None, int(row[2])) for row in rows)


def table(page):
    """Cells of each row of the table of platforms."""
    lines = page.split("| Platform |")[1].split("\n\n")[0].splitlines()[2:]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


def faults(page):
    """What a page claims that the file of hashes does not bear out."""
    for cells in table(page):
        for steps, cell in zip(STEPS, cells[3:], strict=True):
            # a row that has not run with the present hashes shows no count of earlier ones
            if cell not in ("-", "{0} of {0}".format(recorded("cpu", steps))):
                yield f"{cells[0]}, {steps} steps: {cell}"


class GoldenTable(unittest.TestCase):
    page = (ROOT / "docs/determinism.md").read_text(encoding="utf-8")

    def test_counts_are_those_of_the_file(self):
        self.assertEqual(list(faults(self.page)), [])
        ran = [cells for cells in table(self.page) if "-" not in cells[3:]]
        self.assertGreaterEqual(len(ran), 4)

    def test_any_other_count_is_found(self):
        count = recorded("cpu", 30)
        right = f"{count} of {count}"
        more = f"{count + 1} of {count + 1}"
        for wrong in (f"{count - 1} of {count}", f"{count} of {count - 1}", more, "all"):
            self.assertEqual(len(list(faults(self.page.replace(right, wrong, 1)))), 1, wrong)

    def test_a_row_for_each_instruction_set_of_one_build(self):
        names = [cells[0] for cells in table(self.page)]
        for name in ("avx2", "baseline"):
            self.assertEqual(sum(f"`{name}`" in each for each in names), 1, name)

    def test_numbers_of_scenes_in_the_text(self):
        for steps in STEPS:
            self.assertIn(f"of {recorded('cpu', steps)} scenes on the CPU", self.page)
        self.assertIn(f"those of {recorded('cuda-90-13000')} scenes for nvcc 13 on sm_90", self.page)


if __name__ == "__main__":
    unittest.main()
