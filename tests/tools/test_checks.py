"""The check scripts must find what they are made to find: each test plants one fault in a small tree."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

TOOLS = pathlib.Path(__file__).resolve().parents[2] / "tools"


class CheckTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)

    def plant(self, path, content):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(content, encoding="utf-8")

    def run_check(self, name, *options):
        return subprocess.run([sys.executable, TOOLS / f"check_{name}", "--root", self.root, *options], capture_output=True, text=True)

    def assert_clean(self, name, *options):
        result = self.run_check(name, *options)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)

    def assert_finds(self, name, *words):
        result = self.run_check(name)
        self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
        for word in words:
            self.assertIn(word, result.stdout)


class Portability(CheckTest):
    def test_what_an_if_asks_for_may_stand(self):
        self.plant("src/a.h", "#if defined(__GNUC__)\nusing A = int __attribute__((vector_size(16)));\n"
                               "#else\n#endif\n"
                              "#if defined(_WIN32)\n#else\n#include <unistd.h>\n#endif\n#pragma once\n"
                               "// __builtin_x\n")
        self.plant("include/rubble/compiler.h",
                   "#if defined(__GNUC__)\n#define NEAR __attribute__((x))\n#endif\n")
        self.assert_clean("portability")

    def test_words_of_compilers_in_the_open_are_found(self):
        for word in ("__attribute__((x))", "__builtin_prefetch(p)", "[[gnu::x]]", "__PRETTY_FUNCTION__",
                     "#pragma GCC x", "__forceinline"):
            self.plant("src/a.cpp", f"#if defined(__GNUC__)\n#endif\n{word}\n")
            self.assert_finds("portability", "src/a.cpp:3:", "of one compiler")

    def test_words_of_systems_in_the_open_are_found(self):
        for word in ("#include <unistd.h>", "#include <sys/file.h>", "fork();",
                     'open("/proc/self/status");', "sysconf(1);"):
            self.plant("io/a.cpp", f"{word}\n")
            self.assert_finds("portability", "io/a.cpp:1:", "of one system")

    def test_public_headers_have_none_even_behind_an_if(self):
        self.plant("include/rubble/b.h", "#if defined(__GNUC__)\nint a __attribute__((x));\n#endif\n")
        self.assert_finds("portability", "include/rubble/b.h:2:")


class Help(CheckTest):
    def test_every_check_explains_itself(self):
        for name in ("abi", "layers", "layout", "equations", "links", "pages", "portability", "sizes",
                     "units", "words"):
            result = self.run_check(name, "--help")
            self.assertEqual(result.returncode, 0)
            self.assertIn("Checks that", result.stdout)


class Layers(CheckTest):
    def setUp(self):
        super().setUp()
        self.plant("include/rubble/math.h", "#pragma once\n")
        self.plant("include/rubble/world.h", "#include <rubble/math.h>\n")
        self.plant("src/math/hd.h", "#include <rubble/math.h>\n#ifdef __CUDA_ARCH__\n#endif\n")
        self.plant("src/solver/block.h", '#include <cmath>\n#include "math/hd.h"\n')
        self.plant("src/cook/cook.h", '#include "math/hd.h"\n')
        self.plant("src/world/world.cpp", '#include "solver/block.h"\n#include "cook/cook.h"\n#include <rubble/world.h>\n')
        self.plant("io/files.h", "#include <rubble/world.h>\n")
        self.plant("scenes/scenes.h", "#include <rubble/world.h>\n")
        self.plant("apps/cli/main.cpp", '#include "io/files.h"\n#include "scenes/scenes.h"\n')

    def test_clean(self):
        self.assert_clean("layers")

    def test_upward(self):
        self.plant("src/math/sym.h", '#pragma once\n\n#include "solver/block.h"\n')
        self.assert_finds("layers", "src/math/sym.h:3", "solver")

    def test_upward_to_public_header(self):
        self.plant("src/forces/contact.h", "#include <rubble/world.h>\n")
        self.assert_finds("layers", "src/forces/contact.h:1", "world")

    def test_relative_path(self):
        self.plant("src/math/sym.h", '#include "../solver/block.h"\n')
        self.assert_finds("layers", "src/math/sym.h:1")

    def test_sideways(self):
        self.plant("io/other.cpp", '#include "scenes/scenes.h"\n')
        self.assert_finds("layers", "io/other.cpp:1")

    def test_cook_stays_below_world(self):
        self.plant("src/cook/hull.cpp", "#include <rubble/world.h>\n")
        self.assert_finds("layers", "src/cook/hull.cpp:1")

    def test_unknown_room(self):
        self.plant("src/attic/box.h", "\n")
        self.assert_finds("layers", "attic")

    def test_device_macro(self):
        self.plant("src/solver/row.h", "#ifdef __CUDA_ARCH__\n#endif\n")
        self.assert_finds("layers", "__CUDA_ARCH__")


class Equations(CheckTest):
    def setUp(self):
        super().setUp()
        for number in range(1, 18):
            self.plant(f"src/solver/e{number}.h", f"/// \\eq{{S{number}}} text\ntemplate <class R>\nR equation{number}(R x);\n")
        self.assert_clean("equations", "--write")

    def test_clean(self):
        self.assert_clean("equations")
        self.assertIn("| S 14 | Update of the stiffness | `equation14` in", (self.root / "docs/equations.md").read_text())

    def test_two_in_one_place(self):
        (self.root / "src/solver/e5.h").unlink()
        self.plant("src/solver/e6.h", "/// \\eq{S5} \\eq{S6} both\nstruct Block {};\n")
        self.assert_clean("equations", "--write")
        self.assertIn("| S 5 | Force f of the local problem | `Block` in", (self.root / "docs/equations.md").read_text())

    def test_missing(self):
        (self.root / "src/solver/e14.h").unlink()
        self.assert_finds("equations", "S14", "no home")

    def test_twice(self):
        self.plant("src/solver/other.h", "/// \\eq{S3} again\nvoid again();\n")
        self.assert_finds("equations", "S3", "already")

    def test_unknown(self):
        self.plant("src/solver/other.h", "/// \\eq{S18} more\nvoid more();\n")
        self.assert_finds("equations", "no equation S18")

    def test_paper_equation_is_listed(self):
        self.plant("src/solver/other.h", "/// \\eq{P16} ramp\nvoid ramp();\n")
        self.assert_clean("equations", "--write")
        self.assertIn("| P 16 |  | `ramp` in", (self.root / "docs/equations.md").read_text())

    def test_old_index(self):
        self.plant("src/solver/e1.h", "/// \\eq{S1} text\nvoid renamed();\n")
        self.assert_finds("equations", "not up to date")


class Sizes(CheckTest):
    def test_limits(self):
        self.plant("src/math/large.h", "\n" * 301)
        self.plant("docs/long.md", "\n" * 900)
        result = self.run_check("sizes")
        self.assertEqual(result.returncode, 0)
        self.assertIn("large.h: 301 lines", result.stdout)
        self.plant("src/math/huge.h", "\n" * 501)
        self.assert_finds("sizes", "huge.h: 501 lines")


class Units(CheckTest):
    def test_numbers_without_units_pass(self):
        self.plant("src/solver/a.h", "/// Share of L / dt^2 [1], see [S 4].\ninline constexpr Real kShare = 3;\nconst Real a = b[m];\n")
        self.plant("src/world/b.h", "/// Window [m].\ninline constexpr Real kElsewhere = 3;\n")
        self.assert_clean("units")

    def test_units_are_found(self):
        for comment in ("/// Above this speed [m/s] a contact is an impact.\n", "/// A gap [m].\n", "/// A load [N]\n/// of two lines.\n"):
            self.plant("src/stages/a.h", comment + "inline constexpr Real kScale = Real(1);\n")
            self.assert_finds("units", "a.h:", "kScale")
        self.plant("src/stages/a.h", "  constexpr double kRate = 3;  ///< [1/s]\n")
        self.assert_finds("units", "kRate")


class Words(CheckTest):
    def test_clean(self):
        self.plant("src/a.h", "// a word such as network/workflow names no path\n#include <rubble/math.h>\n")
        self.plant("picture.bin", "")
        (self.root / "picture.bin").write_bytes(b"\x89PNG\xff\xfe")
        self.assert_clean("words")

    def test_unfinished(self):
        self.plant("src/a.h", "\n// TO" + "DO: later\n")
        self.assert_finds("words", "src/a.h:2")

    def test_machine_path(self):
        self.plant("docs/a.md", "see /wor" + "k/place\n")
        self.assert_finds("words", "docs/a.md:1")


class Abi(CheckTest):
    HEADER = ("#define RB_API_VERSION {}\ntypedef enum rb_kind {{\n  RB_A = 0,  ///< first\n}} rb_kind;\n"
              "typedef struct rb_pair {{\n  double a[3];\n  {}\n}} rb_pair;\nRB_API void rb_call({});\n")

    def headers(self, version=1, member="int32_t b;", parameters="int a", more=""):
        self.plant("include/rubble/c/types.h", self.HEADER.format(version, member, parameters) + more)

    def test_changes_need_a_version(self):
        self.headers()
        self.plant("c_api/abi.txt", "version 1\n")
        self.assert_clean("abi", "--write")
        self.assert_clean("abi")
        self.headers(more="RB_API int32_t rb_more(void);\n")
        self.assert_finds("abi", "added: function int32_t rb_more(void)")
        self.assert_clean("abi", "--write")
        for change in ({"member": "int64_t b;"}, {"parameters": "int a, int b"}):
            self.headers(**change)
            self.assert_finds("abi", "must be above 1")
            self.assertEqual(self.run_check("abi", "--write").returncode, 1)
            self.headers(version=2, **change)
            self.assert_finds("abi", "is of version 1")
        self.assert_clean("abi", "--write")
        self.assert_clean("abi")


class Links(CheckTest):
    def test_paths_in_prose(self):
        self.plant("src/math/a.h", "")
        self.plant("docs/a.md", "See `src/math/a.h`, `math/a.h` of src and tests/NAME_test.cpp.\n")
        self.assert_clean("links")
        self.plant("docs/b.md", "See `src/math/b.h`.\n")
        self.assert_finds("links", "docs/b.md:1: names src/math/b.h")

    def test_links(self):
        self.plant("docs/a.md", "[b](b.md), [code](../src), [web](https://example.org/x), `[x](y)`\n")
        self.plant("docs/b.md", "\n")
        self.plant("src/a.h", "\n")
        self.assert_clean("links")
        (self.root / "docs/b.md").unlink()
        self.assert_finds("links", "docs/a.md:1", "b.md")


class Pages(CheckTest):
    def test_finds_long_sentences_and_history(self):
        self.plant("docs/a.md", "# A\n\n" + "word " * 36 + ".\n\nIt was red until then.\n")
        self.assert_finds("pages", "docs/a.md:3: a sentence of 36 words", "'was' tells history",
                          "'until then'")

    def test_leaves_code_tables_and_logs_alone(self):
        self.plant("docs/b.md", "```\nit was " + "word " * 40 + "\n```\n\n| it was |\n\nShort `was` here.\n")
        self.plant("docs/research/c.md", "It was red.\n")
        self.assert_clean("pages")


if __name__ == "__main__":
    unittest.main()
