"""Mutants of C++ sources: where an operator can be changed, and sources that hold many changes at once.

A place is an expression, with what it becomes. Clang says where expressions and their operands begin and end
(Python package libclang). In the rewritten source each chosen expression E has the form
`(mutant(number) ? (changed E) : (E))`: with no mutant on, it has the value, the type and the bits of E.
"""
import collections
import hashlib
import re
import subprocess

SIGNS = {"+": "-", "-": "+", "+=": "-=", "-=": "+="}
BOUNDS = {"<": "<=", "<=": "<", ">": ">=", ">=": ">"}
EXTREMES = {"min": "max", "max": "min"}
BINARY = ("BINARY_OPERATOR", "COMPOUND_ASSIGNMENT_OPERATOR", "CALL_EXPR")
# What the compiler itself evaluates: no mutant is on there.
CONSTANT = ("STATIC_ASSERT", "ENUM_CONSTANT_DECL", "CONCEPT_DECL", "TEMPLATE_NON_TYPE_PARAMETER")
CONSTANT_IF = {"VAR_DECL": re.compile(rb"(?:inline |static )*constexpr\b"),
               "IF_STMT": re.compile(rb"if constexpr\b"), "CASE_STMT": re.compile(rb"")}

# The expression at [begin, end) of a file becomes the joined `parts`: text, and (begin, end) of operands.
Place = collections.namedtuple("Place", "file begin end rule parts line last text key")

# Goes into a header that all mutated ones include. Constants are the same with any mutant on.
HELPER = r"""
#include <cstdio>
#include <cstdlib>
#include <type_traits>
namespace rubble::mutants {
inline unsigned char reached[@COUNT@];
struct Run {
  int number = std::getenv("RUBBLE_MUTANT") ? std::atoi(std::getenv("RUBBLE_MUTANT")) : 0;
  ~Run() {
    const char* path = number < 0 ? std::getenv("RUBBLE_MUTANTS_REACHED") : nullptr;
    std::FILE* file = path ? std::fopen(path, "wb") : nullptr;
    if (!file) return;
    std::fwrite(reached, 1, sizeof reached, file);
    std::fclose(file);
  }
};
inline Run run;
inline bool note(int number) {
  reached[number] = 1;
  return false;
}
}  // namespace rubble::mutants
namespace rubble {
constexpr bool mutant(int number) {
  return !std::is_constant_evaluated() &&
         (mutants::run.number == number || (mutants::run.number < 0 && mutants::note(number)));
}
}  // namespace rubble
"""


def plain_type(cursor):
    return cursor.type.get_canonical().spelling.replace("const ", "")


class Source:
    """A file as Clang sees it: positions count bytes."""

    def __init__(self, root, name):
        self.name, self.bytes = name, (root / name).read_bytes()

    def piece(self, begin, end):
        return self.bytes[begin:end].decode()

    def place(self, begin, end, rule, parts):
        """None if the expression cannot be written twice on one line."""
        old = self.piece(begin, end)
        if "//" in old or "#" in old:
            return None
        start = self.bytes.rfind(b"\n", 0, begin) + 1
        new = "".join(part if isinstance(part, str) else self.piece(*part) for part in parts)
        line = self.bytes[start:self.bytes.find(b"\n", end)]
        same = self.bytes.count(line, 0, start)
        key = hashlib.sha256(repr((self.name, line, same, begin - start, new)).encode()).hexdigest()[:16]
        text = f"{' '.join(old.split())}  ->  {' '.join(new.split())}"
        first = self.bytes.count(b"\n", 0, begin) + 1
        return Place(self.name, begin, end, rule, tuple(parts), first, first + old.count("\n"), text, key)

    def places(self, cursor):
        """Places of one expression."""
        begin, end = cursor.extent.start.offset, cursor.extent.end.offset
        found = []
        extreme = re.match(r"((?:\w+::)*)(min|max)(?=[<(])", self.piece(begin, end))
        if cursor.kind.name == "CALL_EXPR" and extreme:
            new = extreme[1] + EXTREMES[extreme[2]]
            found.append(("extreme", [new, (begin + extreme.end(), end)]))
        operands = list(cursor.get_children())
        if len(operands) in (2, 3):
            left, right = operands[0].extent, operands[-1].extent
            a, b = (begin, left.end.offset), (right.start.offset, end)
            symbol = self.piece(a[1], b[0]).strip() if begin == left.start.offset and a[1] < b[0] else ""

            def replaced(new):
                return ["(", a, f") {new} (", b, ")"]

            if symbol in SIGNS:
                found.append(("sign", replaced(SIGNS[symbol])))
            if symbol in ("+", "-"):
                found.append(("term", [a]))
            if symbol == "*":
                found.append(("factor", [a if plain_type(operands[0]) == plain_type(cursor) else b]))
            if symbol in BOUNDS:
                found.append(("bound", replaced(BOUNDS[symbol])))
        made = (self.place(begin, end, rule, parts) for rule, parts in found)
        return [place for place in made if place]


def find(root, names, flags):
    """All places in the files `names` of `root`, which one source can include, in the order of files. Raises
    ImportError without libclang."""
    from clang import cindex
    resources = subprocess.run(["clang", "-print-resource-dir"], check=True, capture_output=True, text=True)
    everything = "".join(f'#include "{root / name}"\n' for name in names)
    unit = cindex.Index.create().parse(
        "everything.cpp", ["-std=c++20", *flags, f"-resource-dir={resources.stdout.strip()}"],
        unsaved_files=[("everything.cpp", everything)])
    for problem in unit.diagnostics:
        if problem.severity >= cindex.Diagnostic.Error:
            raise RuntimeError(f"libclang: {problem}")
    sources = {str(root / name): Source(root, name) for name in names}
    found = {name: {} for name in names}

    def visit(cursor, source):
        kind = cursor.kind.name
        if kind in CONSTANT:
            return
        start, children = cursor.extent.start.offset, list(cursor.get_children())
        if kind in CONSTANT_IF and CONSTANT_IF[kind].match(source.bytes, start):
            if kind == "VAR_DECL":
                return
            children = children[1:]
        if kind in BINARY:
            for place in source.places(cursor):
                found[source.name].setdefault((place.begin, place.end, place.rule), place)
        for child in children:
            visit(child, source)

    for cursor in unit.cursor.get_children():
        file = cursor.location.file
        if file and file.name in sources:
            visit(cursor, sources[file.name])
    return [place for name in names for place in found[name].values()]


def draw(places, seed):
    """All places in an order that depends on the seed, and for each place on nothing else."""
    return sorted(places, key=lambda place: hashlib.sha256(f"{seed} {place.key}".encode()).hexdigest())


def rewritten(content, chosen):
    """The bytes of a file with its chosen places, {place: number}. Lines stay where they are."""

    def render(begin, end, places):
        out, at = "", begin
        while places:
            outer = places[0]
            inside = [place for place in places[1:] if place.end <= outer.end]
            places = places[1 + len(inside):]
            old = render(outer.begin, outer.end, inside)
            new = ""
            for part in outer.parts:
                held = [] if isinstance(part, str) else [
                    place for place in inside if part[0] <= place.begin and place.end <= part[1]]
                new += part if isinstance(part, str) else render(*part, held)
            both = f"(::rubble::mutant({chosen[outer]}) ? ({new}) : ({old}))".replace("\n", " ")
            lines = "\n" * content.count(b"\n", outer.begin, outer.end)
            out += content[at:outer.begin].decode() + both + lines
            at = outer.end
        return out + content[at:end].decode()

    order = sorted(chosen, key=lambda place: (place.begin, -place.end))
    return render(0, len(content), order).encode()
