"""The pages of the C and the Python API have all that the headers and the package have."""
import pathlib
import re
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
import api_pages_c  # noqa: E402
import api_pages_python  # noqa: E402


def written(writer, source):
    with tempfile.TemporaryDirectory() as folder:
        pages = writer.write(source, pathlib.Path(folder, "api"))
        return {path.stem: path.read_text(encoding="utf-8") for path in pages}


class ApiPages(unittest.TestCase):
    def test_pages_of_c_have_every_function_and_struct(self):
        pages, count = written(api_pages_c, ROOT / "include/rubble/c"), 0
        for header in (ROOT / "include/rubble/c").glob("*.h"):
            for name in api_pages_c.names(header.read_text(encoding="utf-8")):
                self.assertRegex(pages[header.stem], rf"\b{name}\b")
                count += 1
        self.assertGreater(count, 200)
        self.assertIn("| `RB_INVALID = 1` | invalid input: path, expected value and found value are given |",
                      pages["types"])
        self.assertIn("```c\nvoid rb_world_destroy(rb_world* world);\n```\n", pages["world"])
        for name, text in pages.items():
            self.assertNotIn("///", text, name)
            self.assertNotIn("RB_API ", text, name)

    def test_pages_of_python_have_every_member(self):
        pages = written(api_pages_python, ROOT / "python/rubble")
        text = "\n".join(pages.values())
        source = api_pages_python.Source(ROOT / "python/rubble")
        for name in source.public:
            self.assertIn(f"## {name}\n", text)
            node = source.found[name]
            for member in source.members(node) if hasattr(node, "bases") else ():
                if not member.startswith("_"):
                    self.assertRegex(text, rf"`{member}`|{name}\.{member}\(")
        for needed in ("World(\n    scene: Scene,\n    *,\n    backend: str=\"cpu\"",
                       "| `mass` | `float` | [kg], in place", "**Raises**\n\n- `Error`:",
                       "| `distance` | `float` | [m]; of a shape cast"):
            self.assertIn(needed, text)
        self.assertEqual(re.findall(r"Unpack|\(self", text), [])

    def test_links_between_the_pages_lead_somewhere(self):
        pages = written(api_pages_python, ROOT / "python/rubble")
        for link, anchor in re.findall(r"\]\((\w+)\.md\)|\]\(#(\w+)\)", "\n".join(pages.values())):
            if link:
                self.assertIn(link, pages)
            else:
                self.assertIn(f"\n## {anchor}\n".lower(), pages["arguments"].lower())


if __name__ == "__main__":
    unittest.main()
