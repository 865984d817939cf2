"""The bill of materials, and the licence texts that come with what is built."""
import json
import os
import pathlib
import re
import subprocess
import sys
import tarfile
import tempfile
import tomllib
import unittest
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


def make_sbom(*arguments, **options):
    command = [sys.executable, ROOT / "tools/make_sbom", *arguments]
    return subprocess.run(command, capture_output=True, text=True, **options)


class Versions(unittest.TestCase):
    WRITTEN = {"libtbb-dev": "2021.8", "libqhull-dev": "2020.2", "CUDA toolkit": "", "libfmt-dev": "9.1.0"}

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def program(self, name, *lines):
        file = self.folder / name
        file.write_text("\n".join(["#!/bin/sh", *lines, ""]), encoding="utf-8")
        file.chmod(0o755)

    def found(self):
        """(version, purl, source) by package, where no other programs are than those that the test makes."""
        done = make_sbom(env={**os.environ, "PATH": str(self.folder)})
        self.assertEqual(done.returncode, 0, done.stderr)
        return {part["bom-ref"].removesuffix(f" {part['version']}"):
                (part["version"], part.get("purl"), part["properties"][0]["value"])
                for part in json.loads(done.stdout)["components"]}

    def test_the_written_ones_where_nothing_says_another(self):
        found = self.found()
        for package, version in self.WRITTEN.items():
            purl = f"pkg:deb/debian/{package}@{version}?distro=debian-12" if version else None
            self.assertEqual(found[package], (version, purl, "THIRD_PARTY.md"))

    def test_those_of_the_machine_go_first(self):
        self.program("dpkg-query", 'echo "libtbb-dev installed 1:2099.1.0-2ubuntu3"',
                     'echo "libqhull-dev not-installed "', "exit 1")
        self.program("pkg-config", '[ "$2" = fmt ] && echo 99.2 && exit 0', '[ "$2" = tbb ] && echo 1',
                     "exit 1")
        self.program("nvcc", 'echo "Cuda compilation tools, release 99.0, V99.0.7"')
        found = self.found()
        version, purl, source = found["libtbb-dev"]
        self.assertEqual((version, source), ("2099.1.0", "dpkg-query"))
        self.assertRegex(purl, r"^pkg:deb/\w+/libtbb-dev@1%3A2099\.1\.0-2ubuntu3\?distro=\w+-")
        self.assertEqual(found["libfmt-dev"], ("99.2", None, "pkg-config"))
        self.assertEqual(found["CUDA toolkit"], ("99.0.7", None, "nvcc"))
        self.assertEqual(found["libqhull-dev"][::2], ("2020.2", "THIRD_PARTY.md"))


class Texts(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.texts = sorted((ROOT / "licenses").iterdir())

    def tree(self, left_out=""):
        target = self.folder / "share/doc/rubble/licenses"
        target.mkdir(parents=True)
        for text in self.texts:
            if text.name != left_out:
                (target / text.name).write_bytes(text.read_bytes())
        return self.folder

    def test_each_linked_library_has_one(self):
        page = (ROOT / "THIRD_PARTY.md").read_text(encoding="utf-8").split("## Used and not linked")[0]
        rows = [line.split(" | ") for line in page.splitlines() if line.startswith("| ")]
        link = re.compile(r"\]\((licenses/[\w-]+\.txt)\)")
        without = [row[0] for row in rows if not link.search(row[3])]
        # the heads of two tables, and what comes with its toolkit
        self.assertEqual(without, ["| library", "| CUDA runtime", "| library"])
        named = sorted(set(re.findall(r"licenses/([\w-]+\.txt)", page)) - {"cuda.txt"})
        self.assertEqual(named, [text.name for text in self.texts])
        for row in rows:
            if file := link.search(row[3]):
                text = (ROOT / file[1]).read_text(encoding="utf-8")
                self.assertIn(row[0].strip("| ").split(" (")[0], text)
                self.assertIn("opyright", text)

    def test_a_tree_with_all_passes_and_one_that_lacks_one_does_not(self):
        self.assertEqual(make_sbom("--texts", self.tree()).returncode, 0)
        (self.folder / "share/doc/rubble/licenses/qhull.txt").write_text("another\n", encoding="utf-8")
        done = make_sbom("--texts", self.folder)
        self.assertEqual(done.returncode, 1)
        self.assertIn("lacks licenses/qhull.txt", done.stdout)

    def test_wheels_and_archives(self):
        for left_out, status in (("", 0), ("onetbb.txt", 1)):
            with (zipfile.ZipFile(self.folder / "a.whl", "w") as wheel,
                  tarfile.open(self.folder / "a.tar.gz", "w:gz") as archive):
                for text in self.texts:
                    if text.name != left_out:
                        wheel.write(text, f"rubble-1.dist-info/licenses/licenses/{text.name}")
                        archive.add(text, f"rubble-1/share/doc/rubble/licenses/{text.name}")
            for file in ("a.whl", "a.tar.gz"):
                done = make_sbom("--texts", self.folder / file)
                self.assertEqual(done.returncode, status, done.stdout + done.stderr)
                self.assertEqual(f"{file} lacks licenses/onetbb.txt" in done.stdout, status == 1)

    def test_a_wheel_takes_them(self):
        settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
        taken = {path for pattern in settings["project"]["license-files"] for path in ROOT.glob(pattern)}
        self.assertLessEqual({ROOT / "LICENSE", ROOT / "THIRD_PARTY.md", *self.texts}, taken)


if __name__ == "__main__":
    unittest.main()
