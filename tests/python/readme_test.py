"""The programs of README.md and docs/python.md do what they say."""
import contextlib
import io
import pathlib
import re

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


if __name__ == "__main__":
    main()
