"""The programs of README.md and docs/python.md do what they say."""
import contextlib
import io
import pathlib
import re
import runpy

from support import Case, main

ROOT = pathlib.Path(__file__).resolve().parents[2]


def output_of(page):
    """What the first Python program of a page prints."""
    program = re.search(r"```python\n(.*?)```", (ROOT / page).read_text(encoding="utf-8"), re.DOTALL).group(1)
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        exec(compile(program, page, "exec"), {})
    return said.getvalue()


class Pages(Case):
    def test_the_tower_of_the_readme_stands(self):
        self.assertRegex(output_of("README.md"), r"^the top brick rests at 4\.7[0-6] m\n$")

    def test_the_crate_of_the_page_rests(self):
        numbers = [float(number) for number in re.findall(r"[-\d.e]+", output_of("docs/python.md"))]
        self.assertNear(numbers, (0, 0, 0.5), 0.01)

    def test_the_tutorial_prints_what_its_page_shows(self):
        page = (ROOT / "docs/tutorial.md").read_text(encoding="utf-8")
        program = runpy.run_path(str(ROOT / "examples/knock_wall.py"), run_name="tutorial")
        for part in range(1, 7):
            said = io.StringIO()
            with contextlib.redirect_stdout(said):
                program["main"](part)
            self.assertIn(f"<!-- prints {part} -->\n```\n{said.getvalue()}```\n", page)


if __name__ == "__main__":
    main()
