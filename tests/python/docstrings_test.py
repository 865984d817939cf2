"""Every public member of the package says what it is."""
import ast
import importlib.util
import inspect
import pathlib
import re
import typing

from support import Case, main  # first: it skips the test where numpy is missing

import rubble

PACKAGE = pathlib.Path(rubble.__file__).parent
OF_PYTHON = {"count", "index", "args", "add_note", "with_traceback"}


def meanings_of_fields():
    """The comments "#: ..." of the fields of named tuples, by class and field."""
    found = {}
    for file in PACKAGE.glob("_*.py"):
        text = file.read_text(encoding="utf-8")
        lines = text.splitlines()
        for node in ast.parse(text).body:
            if isinstance(node, ast.ClassDef):
                for field in node.body:
                    if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name):
                        beside = lines[field.lineno - 1].partition("#:")[2]
                        above = lines[field.lineno - 2].strip()
                        found[node.name, field.target.id] = beside or above.startswith("#:")
    return found


def modules():
    """Of the package; the environments where Gymnasium is there."""
    if importlib.util.find_spec("gymnasium"):
        from rubble import gym
        return [rubble, gym]
    return [rubble]


def members():
    """Name and object of each public class, function, method and property."""
    for module in modules():
        for name in module.__all__:
            item = getattr(module, name)
            if not (inspect.isclass(item) or inspect.isfunction(item)):
                continue
            yield name, item
            if inspect.isclass(item):
                for key in dir(item):
                    if not key.startswith("_") and key not in OF_PYTHON:
                        yield f"{name}.{key}", inspect.getattr_static(item, key)


class Docstrings(Case):
    def test_all_have_one(self):
        count, bare = 0, []
        for name, item in members():
            if isinstance(item, property):
                item = item.fget
            item = getattr(item, "__func__", item)
            if inspect.isfunction(item) or inspect.isclass(item):
                count += 1
                if not (item.__doc__ or "").strip():
                    bare.append(name)
        self.assertEqual(bare, [])
        self.assertGreater(count, 200)

    def test_fields_of_named_tuples_have_a_comment(self):
        meanings, count = meanings_of_fields(), 0
        for name in rubble.__all__:
            for field in typing.cast(typing.Any, getattr(rubble, name)).__dict__.get("_fields", ()):
                self.assertTrue(meanings[name, field], f"{name}.{field}")
                count += 1
        self.assertGreater(count, 50)

    def test_they_name_only_what_there_is(self):
        """`Name` and `Name.member` in a docstring are of the package."""
        for name, item in members():
            text = getattr(item, "__doc__", None) or ""
            for word in re.findall(r"(?<!`)`([A-Z]\w+(?:\.\w+)?)`(?!`)", text):
                owner, _, member = word.partition(".")
                if owner in ("KeyError", "IndexError", "RuntimeError"):
                    continue
                found = next((getattr(module, owner) for module in modules() if hasattr(module, owner)), None)
                self.assertIsNotNone(found, f"{name}: `{word}`")
                if member:
                    self.assertTrue(hasattr(found, member), f"{name}: `{word}`")


if __name__ == "__main__":
    main()
