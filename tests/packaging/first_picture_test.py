"""The first picture is built from its own part of the libraries: nothing else is compiled for it, and
nothing twice.

usage: first_picture_test.py BUILD_FOLDER
"""
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

_FOLDER = sys.argv.pop(1)
_ITS_LIBRARIES = {"first_picture", "rubble_core_f32", "rubble_first", "rubble_io_first",
                  "rubble_render_first", "rubble_scenes_first"}
# a few lines that know which cores there are
_CHOOSING = {"src/world/backends.cpp", "src/backend/cuda_support.cpp"}


def commands(target):
    listed = subprocess.run(["ninja", "-C", _FOLDER, "-t", "commands", target],
                            check=True, capture_output=True, text=True)
    return listed.stdout.splitlines()


def objects(target):
    """(library, object) of each file that is compiled for a target."""
    found = [re.search(r" -o CMakeFiles/([^/ ]+)\.dir/(\S+\.o) -c ", line) for line in commands(target)]
    return {one.groups() for one in found if one}


class FirstPicture(unittest.TestCase):
    def test_compiles_its_own_part_of_the_libraries_alone(self):
        self.assertEqual({library for library, _ in objects("first_picture")}, _ITS_LIBRARIES)

    def test_links_no_archive_of_the_project(self):
        self.assertNotRegex(commands("first_picture")[-1], r"librubble\w*\.a")

    def test_shares_its_other_objects_with_the_c_library(self):
        own = {one for one in objects("first_picture") if one[0] != "first_picture"}
        self.assertLessEqual(own, objects("rubble_c"))

    def test_compiles_the_choice_of_cores_alone_anew(self):
        own = {name.removesuffix(".o") for library, name in objects("first_picture")
               if library == "first_picture"}
        self.assertEqual(own, _CHOOSING | {"apps/first_picture/main.cpp"})

    def test_finds_all_that_it_calls_in_its_part_of_the_libraries(self):
        with tempfile.TemporaryDirectory() as folder:
            for line in commands("first_picture"):
                if "first_picture" not in line:
                    continue
                own = line.replace("CMakeFiles/first_picture.dir", folder)
                own = own.replace("-o first_picture", f"-o {folder}/first_picture")
                pathlib.Path(re.search(r" -o (\S+)", own).group(1)).parent.mkdir(parents=True, exist_ok=True)
                done = subprocess.run(own, shell=True, cwd=_FOLDER, capture_output=True, text=True)
                self.assertEqual(done.returncode, 0, done.stderr[-2000:])
            self.assertTrue(pathlib.Path(folder, "first_picture").exists())


if __name__ == "__main__":
    unittest.main()
