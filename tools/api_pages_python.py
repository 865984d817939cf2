"""API pages in Markdown from the sources and stubs of python/rubble. It needs nothing but Python."""
import ast
import inspect
import re

# Page: its title, and the public names on it.
PAGES = {
    "scene": ("Scenes", ["Scene", "Rod", "load"]),
    "shapes": ("Shapes", ["box", "sphere", "capsule", "cylinder", "cone", "plane", "hull", "compound", "mesh",
                          "height_field", "distance_field", "mass_of", "Mass"]),
    "world": ("World", ["World", "Params", "Snapshot", "StepReport", "Array", "DeviceArray"]),
    "worlds": ("Many worlds", ["Worlds"]),
    "bodies": ("Bodies and shapes of a world", ["Bodies", "Body", "ContactLoad", "Shapes", "Shape"]),
    "joints": ("Joints of a world", ["Joints", "Joint", "JointState", "AxisState"]),
    "deformables": ("Deformable objects", [
        "Deformables", "Deformable", "Surface", "Attachments", "Attachment", "tet_box", "tet_ball",
        "tet_solid", "cloth_sheet", "straight_cable", "cable_along"]),
    "results": ("Hits, events and measures", ["Hit", "Events", "DebugDraw", "Quality", "RayHits"]),
    "sensors": ("Sensors and actuators", ["Sensors", "Actuators"]),
    "pictures": ("Pictures and recordings", [
        "Painter", "Film", "save_png", "Recorder", "Recording", "Frame"]),
    "registry": ("Scene registry", ["scenes", "SceneInfo", "Argument", "Run", "Verdict", "Claim"]),
    "general": ("Errors and information", ["Error", "info"]),
}
# Environments, from rubble.gym.
GYM = ("Environments", ["make", "WorldsEnv", "uniform", "CartPole", "Ant", "Humanoid", "Quadruped", "FourBar",
                        "LiftCube", "LiftSoft", "StackWall"])
# Classes that only the package makes.
MADE = {"Film", "Body", "Shape", "Joint", "Deformable", "Attachment", "Bodies", "Shapes", "Joints",
        "Deformables", "Attachments", "Params", "Snapshot", "StepReport", "Array", "DeviceArray", "Error"}
SHOWN = ("__init__", "__getitem__", "__setitem__", "__len__")
SECTION = re.compile(r"^(Args|Arguments|Returns|Raises|Attributes):(.*)$")


class Source:
    """Classes and functions of a folder of Python files by name."""

    def __init__(self, folder):
        self.found, self.lines = {}, {}
        for file in sorted(set(folder.glob("*.py")) - {folder / "_abi.py"}):
            text = file.read_text(encoding="utf-8")
            for node in ast.parse(text).body:
                if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
                    self.found.setdefault(node.name, node)
                    self.lines[node] = text.splitlines()
        init = ast.parse((folder / "__init__.py").read_text(encoding="utf-8"))
        self.public = next(ast.literal_eval(node.value) for node in init.body if isinstance(node, ast.Assign)
                           and getattr(node.targets[0], "id", "") == "__all__")

    def bases(self, node):
        """The class and those of the package that it is derived from."""
        out = [node]
        for base in node.bases:
            name = getattr(base, "id", "")
            if name in self.found:
                out += self.bases(self.found[name])
        return out

    def members(self, node):
        """Public members by name, inherited ones included; what a class says itself comes first."""
        found = {}
        for each in self.bases(node):
            for item in each.body:
                if not isinstance(item, ast.FunctionDef) or decorated(item, "setter"):
                    continue
                if not item.name.startswith("_") or item.name in SHOWN:
                    found.setdefault(item.name, item)
        return found

    def writable(self, node):
        return {item.name for each in self.bases(node) for item in each.body
                if isinstance(item, ast.FunctionDef) and decorated(item, "setter")}

    def fields(self, node):
        """Fields of a named tuple with their comments."""
        lines = self.lines[node]
        for item in node.body:
            if isinstance(item, ast.AnnAssign) and not item.target.id.startswith("_"):
                meaning = lines[item.lineno - 1].partition("#:")[2].strip()
                row = item.lineno - 2
                above = []
                while not meaning and lines[row].strip().startswith("#:"):
                    above.insert(0, lines[row].strip().removeprefix("#:").strip())
                    row -= 1
                yield item.target.id, ast.unparse(item.annotation), meaning or " ".join(above)


def decorated(function, name):
    return any(getattr(each, "attr", getattr(each, "id", "")) == name for each in function.decorator_list)


def doc_of(node):
    return inspect.cleandoc(ast.get_docstring(node) or "")


def markdown(doc):
    """A docstring with sections as Markdown: an item for each argument, error and attribute."""
    lines, out, inside = doc.splitlines(), [], False
    for line in lines:
        section = SECTION.match(line)
        if section:
            after = f": {section.group(2).strip()}" if section.group(2) else ""
            out += ["", f"**{section.group(1)}**{after}", ""]
            inside = True
        elif inside and re.match(r"    \S", line):
            item = re.match(r"    ([\w, ]+): (.*)", line)
            out.append(f"- `{item.group(1)}`: {item.group(2)}" if item else "- " + line.strip()
                       if out[-1] == "" else "  " + line.strip())
        elif inside and line.startswith("        "):
            out.append("  " + line.strip())
        else:
            inside = False
            out.append(line)
    return re.sub(r"\n{3,}", "\n\n", "\n".join(out)).strip()


def signature(function, title):
    """A call as code, in lines of at most 100 columns."""
    arguments = ast.unparse(function.args)
    arguments = re.sub(r"^(self|cls)(, )?", "", arguments)
    result = f" -> {ast.unparse(function.returns)}" if function.returns else ""
    if title and function.name == "__init__":
        result = ""
    one = f"{title}({arguments}){result}".replace("Unpack[", "").replace("'", '"')
    one = re.sub(r"(\*\*\w+: \w+)\]", r"\1", one)
    if len(one) <= 100:
        return one
    return re.sub(r", (?=\*{0,2}\w+:|\*, )", ",\n    ", one.replace("(", "(\n    ", 1))


def cell(text):
    return re.sub(r"\s+", " ", text).replace("|", "\\|")


def class_lines(source, node):
    lines, members = [f"## {node.name}", ""], source.members(node)
    start = members.pop("__init__", None)
    is_tuple = any(getattr(base, "id", "") == "NamedTuple" for base in node.bases)
    if start and len(start.args.args + start.args.kwonlyargs) > 1 and node.name not in MADE:
        lines += ["```python", signature(start, node.name), "```", ""]
    lines += [markdown(doc_of(node)), ""]
    if is_tuple:
        lines += ["| Field | Type | Meaning |", "|---|---|---|"]
        lines += [f"| `{name}` | `{cell(kind)}` | {cell(meaning)} |"
                  for name, kind, meaning in source.fields(node)]
        return [*lines, ""]
    values = {name: each for name, each in members.items() if decorated(each, "property")}
    writable = source.writable(node)
    if values:
        lines += ["| Property | Type | Meaning |", "|---|---|---|"]
        for name, each in values.items():
            kind = ast.unparse(each.returns) if each.returns else ""
            assigned = ", can be assigned" if name in writable else ""
            lines.append(f"| `{name}` | `{cell(kind)}`{assigned} | {cell(markdown(doc_of(each)))} |")
        lines.append("")
    for name, each in members.items():
        if name in values or (name.startswith("__") and not doc_of(each)):
            continue
        title = name if decorated(each, "property") else f"{node.name}.{name}"
        lines += ["```python", signature(each, title), "```", "", markdown(doc_of(each)), ""]
    return lines


def page(title, source, names):
    lines = [f"# {title}", ""]
    for name in names:
        node = source.found[name]
        if isinstance(node, ast.ClassDef):
            lines += class_lines(source, node)
        else:
            lines += [f"## {name}", "", "```python", signature(node, name), "```", ""]
            lines += [markdown(doc_of(node)), ""]
    return re.sub(r"\n{3,}", "\n\n", "\n".join(lines)).rstrip() + "\n"


def arguments_page(stubs):
    """Keyword arguments, from the stubs."""
    lines = ["# Keyword arguments", "", "Keys of definitions and options, by their names in signatures.", ""]
    for text in stubs:
        for node in ast.parse(text).body:
            if not isinstance(node, ast.ClassDef):
                continue
            base = node.bases[0].id
            lines += [f"## {node.name}", ""]
            if base != "TypedDict":
                lines += [f"As [{base}](#{base.lower()}), and:", ""]
            lines += ["| Key | Type | Meaning |", "|---|---|---|"]
            for at, item in enumerate(node.body):
                if isinstance(item, ast.AnnAssign):
                    after = node.body[at + 1:at + 2]
                    told = after and isinstance(after[0], ast.Expr)
                    meaning = ast.literal_eval(after[0].value) if told else ""
                    kind = re.sub(r"_(bodies|soft)\.", "", ast.unparse(item.annotation).replace("'", '"'))
                    lines.append(f"| `{item.target.id}` | `{cell(kind)}` | {cell(meaning)} |")
            lines.append("")
    return "\n".join(lines).rstrip() + "\n"


def index(listed):
    lines = ["# Python API", "",
             "Written from the docstrings of the package. Its guide: [Python](../../python.md).", "",
             "| Page | Content |", "|---|---|"]
    for name, title, names in listed:
        lines.append(f"| [{title}]({name}.md) | {', '.join(f'`{each}`' for each in names)} |")
    return "\n".join(lines) + "\n"


def write(package, target):
    """Writes the pages of the package to `target`. Returns their paths, that of the index first."""
    target.mkdir(parents=True, exist_ok=True)
    source, gym = Source(package), Source(package / "gym")
    missing = set(source.public) - {name for _, names in PAGES.values() for name in names}
    if missing:
        raise SystemExit(f"api_pages_python: no page has {', '.join(sorted(missing))}")
    stubs = [(package / f"{name}.pyi").read_text(encoding="utf-8") for name in ("_fields", "_options")]
    texts = {name: page(title, source, names) for name, (title, names) in PAGES.items()}
    texts["gym"] = page(GYM[0], gym, GYM[1])
    texts["arguments"] = arguments_page(stubs)
    listed = [(name, title, names) for name, (title, names) in PAGES.items()]
    listed.append(("gym", *GYM))
    listed.append(("arguments", "Keyword arguments", ["BodyOptions", "JointFields", "WorldOptions"]))
    pages = []
    for name, text in {"index": index(listed), **texts}.items():
        pages.append(target / f"{name}.md")
        pages[-1].write_text(text, encoding="utf-8")
    return pages
