"""What the check scripts share: the files of the project, and how a check reports."""
import argparse
import os
import pathlib
import subprocess
import sys

LEFT_OUT = {".git", "build", "out", "__pycache__", ".cache"}


def files(root, suffixes=None):
    """The project's files under `root`, sorted, as paths relative to it: what git knows or would add, else all that is no build output."""
    try:
        listed = subprocess.run(
            ["git", "-c", f"safe.directory={root}", "-C", str(root), "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
            check=True, capture_output=True, text=True).stdout.split("\0")
        paths = [pathlib.PurePosixPath(name) for name in listed if name and (root / name).is_file()]
    except (OSError, subprocess.CalledProcessError):
        paths = []
        for folder, folders, names in os.walk(root):
            folders[:] = [name for name in folders if name not in LEFT_OUT]
            here = pathlib.PurePosixPath(pathlib.Path(folder).relative_to(root))
            paths += [here / name for name in names]
    return sorted(path for path in set(paths) if suffixes is None or path.suffix in suffixes)


def text(root, path):
    """Content of a file, or None if it is not text."""
    try:
        return (root / path).read_text(encoding="utf-8")
    except UnicodeDecodeError:
        return None


def parser(doc):
    """An argument parser with the description `doc` and the option --root."""
    result = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    result.add_argument("--root", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parent.parent,
                        help="project folder (default: the one this script lies in)")
    return result


def finish(name, problems, summary):
    """Prints the problems, or the summary if there are none, and exits with 1 or 0."""
    for problem in problems:
        print(problem)
    if problems:
        print(f"{name}: {len(problems)} problem{'s' if len(problems) > 1 else ''}")
        sys.exit(1)
    print(f"{name}: {summary}")
    sys.exit(0)
