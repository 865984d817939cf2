"""Claims about tools/check_layout: it finds what changes the binary interface, and lets additions through."""
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

TOOL = pathlib.Path(__file__).resolve().parents[2] / "tools/check_layout"
HEADER = """#include <stdint.h>
#define RB_API
#define RB_API_VERSION {version}
#define RB_SIZE {size}
typedef enum rb_kind {{ RB_BOX = {box} }} rb_kind;
typedef struct rb_state {{ {members} float data[RB_SIZE]; }} rb_state;
RB_API rb_kind rb_take(const rb_state* state, {parameter} count);
{more}
"""
PLAIN = {"version": 1, "size": 3, "box": 0, "members": "int32_t a; double b;", "parameter": "int32_t",
         "more": ""}
MORE = "RB_API void rb_more(void);"


@unittest.skipUnless(shutil.which("abidiff"), "expected abidiff, of the package abigail-tools")
class Layout(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        self.plant("c_api/exports.map", "RUBBLE_C_1 { global: rb_*; local: *; };\n")
        self.plant("CMakeLists.txt", "project(rubble VERSION 0.1.0 LANGUAGES CXX)\n")
        self.headers()
        self.assertEqual(self.check("--write")[0], 0)

    def plant(self, path, content):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(content)

    def headers(self, **changes):
        self.plant("include/rubble/c/types.h", HEADER.format(**{**PLAIN, **changes}))

    def check(self, *options):
        done = subprocess.run([sys.executable, TOOL, "--root", self.root, *options], capture_output=True,
                              text=True)
        return done.returncode, done.stdout + done.stderr

    def assert_finds(self, words, *options):
        status, said = self.check(*options)
        self.assertEqual(status, 1, said)
        self.assertIn(words, said)

    def test_what_programs_were_compiled_with_must_not_change(self):
        self.assertEqual(self.check()[0], 0)
        for change in ({"members": "int32_t a; float b;"}, {"members": "double b; int32_t a;"}, {"size": 4},
                       {"box": 1}, {"parameter": "int64_t"}):
            with self.subTest(change):
                self.headers(**change)
                self.assert_finds("must be above 1")
        self.assert_finds("must be above 1", "--write")

    def test_versions_of_symbols_must_not_change(self):
        self.plant("c_api/exports.map", "RUBBLE_C_2 { global: rb_*; local: *; };\n")
        self.assert_finds("must be above 1")

    def test_a_new_version_may_change_all(self):
        self.headers(version=2, size=4)
        self.assert_finds("run tools/check_layout --write")
        self.assertEqual(self.check("--write")[0], 0)
        self.assertEqual(self.check()[0], 0)
        self.headers(size=4)
        self.assert_finds("the version is 1, that of the dump 2")

    def test_additions_keep_the_version(self):
        self.headers(more=MORE)
        self.assert_finds("run tools/check_layout --write")
        self.assertEqual(self.check("--write")[0], 0)
        self.headers()
        self.assert_finds("must be above 1")

    def test_a_library_has_all_symbols(self):
        library, map_file = self.root / "librubble_c.so", self.root / "c_api/exports.map"
        for function, major, status in (("rb_take", 0, 0), ("rb_take", 1, 1), ("rb_give", 0, 1)):
            subprocess.run(["cc", "-shared", "-fPIC", "-x", "c", "-", "-o", library,
                            f"-Wl,-soname,librubble_c.so.{major}", f"-Wl,--version-script={map_file}"],
                           input=f"int {function}(void) {{ return 0; }}", text=True, check=True)
            found, said = self.check(library)
            self.assertEqual(found, status, said)


if __name__ == "__main__":
    unittest.main()
