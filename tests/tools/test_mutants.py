"""Claims about tools/mutants.py: what it changes, and that its sources are as before with no mutant on."""
import importlib.util
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
import mutants  # noqa: E402

SOURCE = """#include "helper.h"
constexpr int kFour = 2 + 2;
inline int area(int a, int b) { return a * b - kFour; }
template <class T> T low(T a, T b) { return std::min(a, area(a + 1,
                                                             b)); }
"""
MAIN = """#include <cstdio>
#include <algorithm>
#include "source.h"
int main() { std::printf("%d %d", area(5, 3), low(50, 1)); }
"""


def place(begin, end, parts):
    return mutants.Place("a.h", begin, end, "rule", parts, 1, 1, "", str(begin))


class Rewriting(unittest.TestCase):
    def test_nests_places_and_keeps_lines(self):
        content = b"x = a +\n b - c;\n"
        inner = place(4, 10, ((4, 5),))  # a + b without b
        outer = place(4, 14, ("(", (4, 10), ") + (", (13, 14), ")"))
        self.assertEqual(mutants.rewritten(content, {outer: 1, inner: 2}).decode(),
                         "x = (::rubble::mutant(1) ? (((::rubble::mutant(2) ? (a) : (a +  b)) ) + (c)) : "
                         "((::rubble::mutant(2) ? (a) : (a +  b))  - c))\n;\n")

    def test_the_draw_of_a_place_depends_on_no_other(self):
        places = [place(k, k + 1, ()) for k in range(20)]
        order = mutants.draw(places, 7)
        self.assertEqual(mutants.draw(places[::2], 7), [one for one in order if one in places[::2]])
        self.assertNotEqual(mutants.draw(places, 8), order)


@unittest.skipUnless(importlib.util.find_spec("clang"), "expected the package libclang")
class Places(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.folder.name)
        helper = mutants.HELPER.replace("@COUNT@", "99")
        (self.root / "helper.h").write_text("#include <algorithm>\n" + helper)
        (self.root / "source.h").write_text(SOURCE)
        (self.root / "main.cpp").write_text(MAIN)
        self.found = mutants.find(self.root, ["source.h"], [])

    def tearDown(self):
        self.folder.cleanup()

    def test_lie_outside_of_constants(self):
        self.assertEqual(sorted((one.line, one.rule, one.text) for one in self.found),
                         [(3, "factor", "a * b  ->  a"), (3, "sign", "a * b - kFour  ->  (a * b) + (kFour)"),
                          (3, "term", "a * b - kFour  ->  a * b"),
                          (4, "extreme", "std::min(a, area(a + 1, b))  ->  std::max(a, area(a + 1, b))"),
                          (4, "sign", "a + 1  ->  (a) - (1)"), (4, "term", "a + 1  ->  a")])

    def test_each_is_switched_on_alone(self):
        chosen = {one: number for number, one in enumerate(self.found, 1)}
        path = self.root / "source.h"
        path.write_bytes(mutants.rewritten(path.read_bytes(), chosen))
        program = self.root / "main"
        subprocess.run(["c++", "-std=c++20", str(self.root / "main.cpp"), "-o", str(program)], check=True)

        def output(number):
            return subprocess.run([program], env={"RUBBLE_MUTANT": str(number)}, check=True,
                                  capture_output=True, text=True).stdout

        by_text = {(one.rule, one.text[:5]): output(number) for one, number in chosen.items()}
        self.assertEqual(output(0), "11 47")
        self.assertEqual(by_text, {("factor", "a * b"): "1 47", ("sign", "a * b"): "19 50",
                                   ("term", "a * b"): "15 50", ("extreme", "std::"): "11 50",
                                   ("sign", "a + 1"): "11 45", ("term", "a + 1"): "11 46"})


if __name__ == "__main__":
    unittest.main()
