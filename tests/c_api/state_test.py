"""What the shared library can write to and no object holds: constants that are made once, and a short list.

Arguments: library, folder of the sources."""
import pathlib
import re
import subprocess
import sys

# Each has its line in docs/embedding.md.
STATE = {
    "rubble::(anonymous namespace)::shared()::record": "processes that share worlds, under a lock",
    "rubble::render::(anonymous namespace)::displayUses()::uses": "contexts of EGL displays, under a lock",
    "rubble::(anonymous namespace)::loopsHere()::here": "what runs the loops of a thread, during a call",
    "rubble::c::(anonymous namespace)::lastError()::error": "the last error of a thread",
    "rubble::c::keepText(std::string)::kept": "the last text that a thread was given",
}
STRING = "std::__cxx11::basic_string<char, std::char_traits<char>, std::allocator<char> >"
FOLDERS = ["src", "c_api", "io", "convert", "render", "scenes", "include", "apps"]


def listed(*command):
    return subprocess.run(["readelf", *command, library], check=True, capture_output=True, text=True).stdout


def writable():
    """Names of variables in sections that stay writable; those of .data.rel.ro do not."""
    sections = dict(re.findall(r"^\s*\[\s*(\d+)\]\s+(\.\S+)", listed("-SW"), re.MULTILINE))
    for line in listed("-sWC").splitlines():
        row = line.split(None, 7)
        if len(row) == 8 and row[3] in ("OBJECT", "TLS") and \
                re.match(r"\.(data|t?bss|tdata)(?!\.rel\.ro)", sections.get(row[6], "")):
            yield row[7].replace(STRING, "std::string").replace("[abi:cxx11]", "")


def is_constant(name):
    """Does each declaration of this variable in the sources say const?"""
    own = re.escape(re.sub(r"<.*>$", "", name).rsplit("::", 1)[-1])
    lines = [line for line in code if re.search(rf"[\w>\]*&)] {own}(\[\w*\])*( =|;|\{{|$)", line)]
    declares = re.compile(r"(static|thread_local|inline|extern|const|constexpr) ")
    declared = [line for line in lines if declares.match(line)]
    return bool(declared) and all(re.search(r"\bconst(expr)?\b", line) for line in declared)


library, root = sys.argv[1], pathlib.Path(sys.argv[2])
code = [line.strip() for folder in FOLDERS for path in sorted((root / folder).rglob("*"))
        if path.suffix in {".h", ".cpp", ".cu", ".cuh"}
        for line in path.read_text(encoding="utf-8").splitlines()]
try:
    found = sorted(set(writable()))
except FileNotFoundError:
    print("skipped: readelf is missing")
    sys.exit(77)
# not those of compilers and of other libraries
own = [name for name in found if name.startswith("rubble::")]
unknown = [name for name in own if name not in STATE and not is_constant(name)]
for name in unknown:
    print(f"state of the process that no list has: {name}")
missing = sorted(set(STATE) - set(own))
for name in missing:
    print(f"on the list of states, but not in the library: {name}")
print(f"{len(own)} variables, of which {len(STATE)} are no constants")
sys.exit(bool(unknown or missing or not own))
