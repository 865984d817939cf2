#!/usr/bin/env python3
"""Compiles the C++ on the pages, parses their Python and JSON, and looks up the options of their commands.

usage: page_code.py COMPILER [RUBBLE]    COMPILER: for C++20; RUBBLE: the program, for the commands"""
import json
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
BLOCK = re.compile(r"(?:<!-- ([^\n]*) -->\n)?^```(\w+)\n(.*?)^```", re.S | re.M)
# What the blocks of a page go on from.
BEFORE = {
    "docs/embedding.md": "rubble::Scene scene; rubble::WorldOptions options;"
                         "static struct Host { void log(int, std::string_view) {} } host;"
                         "static struct Jobs { void start(std::function<void()>) {} void wait() {} } jobs;",
    "docs/howto/arrays.md": "extern rubble::World& world;",
    "docs/joints.md": "using namespace rubble; Scene scene; World world(scene); BodyId lamp, hook, flap, box;"
                      "Vec3 axis; int tip, leaf, shaft, output, sun, planet, arm, finger, palm;"
                      "double teethOfPlanet, teethOfSun;",
    "docs/soft.md": "rubble::Scene scene;",
    "docs/start.md": "rubble::Scene scene;",
    "docs/worlds.md": "rubble::Scene scene, anotherScene; rubble::WorldOptions options;"
                      "rubble::Worlds worlds(options); std::vector<int> done, numbers;"
                      "std::vector<double> masses, stiffness, vectors;"
                      "struct { std::vector<rubble::SensorDef> sensors; } file;",
}
# Headers of others that pages include, which a machine need not have.
HEADERS = {"cuda_runtime_api.h": "typedef struct CUstream_st* cudaStream_t;\n"}
# Blocks that are programs of their own are built by other tests; those of extending.md stand for
# tests/extension/extension.h, with parts left out.
ELSEWHERE = {"README.md", "docs/extending.md"}


def pages():
    return [path for path in [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
            if "research" not in path.parts]


def cpp_of(name, number, code):
    """A block as a function, or as declarations if it has functions of its own."""
    includes = re.findall(r"^#include .*$", code, re.M)
    body = re.sub(r"^#include .*$", "", code, flags=re.M)
    before = BEFORE.get(name, "")
    if re.search(r"^void \w+\(", body, re.M):
        return includes, f"namespace page{number} {{\n{body}\n}}\n"
    # what the page declares itself is not declared before
    for declared in re.findall(r"\b(?:rubble::)?(?:World|Worlds|WorldsOptions) (\w+)\b", body):
        before = re.sub(r"(?:extern )?rubble::\w+&? " + declared + r"(?:\(\w+\))?;", "", before)
    return includes, f"void page{number}() {{\n{before}\n{body}\n}}\n"


def compile_blocks(compiler):
    includes, functions, names = {"#include <rubble/rubble.h>", "#include <rubble/sensors.h>",
                                    "#include <rubble/worlds.h>"}, [], []
    for page in pages():
        name = page.relative_to(ROOT).as_posix()
        for mark, language, code in BLOCK.findall(page.read_text(encoding="utf-8")):
            if language != "cpp" or mark or name in ELSEWHERE:
                continue
            found, function = cpp_of(name, len(functions), code)
            includes.update(found)
            functions.append(f'#line 1 "{name}: block"\n' + function)
            names.append(name)
    text = "\n".join(sorted(includes)) + "\n" + "".join(functions)
    with tempfile.TemporaryDirectory() as folder:
        for name, content in HEADERS.items():
            pathlib.Path(folder, name).write_text(content, encoding="utf-8")
        source = pathlib.Path(folder, "pages.cpp")
        source.write_text(text, encoding="utf-8")
        done = subprocess.run([compiler, "-std=c++20", "-fsyntax-only", f"-I{ROOT / 'include'}",
                               f"-I{folder}", str(source)], capture_output=True, text=True)
    if done.returncode:
        sys.exit("C++ on pages does not compile:\n" + done.stderr)
    return len(functions)


def parse_json(text):
    """One value after the other."""
    while text.strip(" \n,"):
        text = text.lstrip(" \n,")
        text = text[json.JSONDecoder().raw_decode(text)[1]:]


def parse_blocks():
    count = 0
    for page in pages():
        for _, language, code in BLOCK.findall(page.read_text(encoding="utf-8")):
            if language == "python":
                compile(code, page.name, "exec")
            elif language == "json":
                parse_json(code if code.lstrip()[0] in "{[" else "{" + code + "}")
            else:
                continue
            count += 1
    return count


def check_commands(rubble):
    """Every option of every line that runs rubble must be in the help of its command."""
    helps, count = {}, 0
    for page in pages():
        for _, language, code in BLOCK.findall(page.read_text(encoding="utf-8")):
            if language != "sh":
                continue
            for line in code.replace("\\\n", " ").splitlines():
                words = shlex.split(line, comments=True)
                at = next((i for i, word in enumerate(words) if word.split("/")[-1] == "rubble"), None)
                if at is None or at + 1 >= len(words) or words[0] in ("source", "docker", "tools/race"):
                    continue
                command = words[at + 1]
                if command not in helps:
                    helps[command] = subprocess.run([rubble, command, "--help"], capture_output=True,
                                                    text=True, check=True).stdout
                options = set(re.findall(r"(?<![\w-])--?[a-zA-Z][\w-]*", helps[command]))
                for word in words[at + 2:]:
                    if re.match(r"--?[a-zA-Z]", word) and word.split("=")[0] not in options:
                        sys.exit(f"{page.relative_to(ROOT)}: 'rubble {command}' has no option {word}")
                count += 1
    return count


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    print(f"{compile_blocks(sys.argv[1])} blocks of C++ compile")
    print(f"{parse_blocks()} blocks of Python and JSON parse")
    if len(sys.argv) > 2:
        print(f"{check_commands(sys.argv[2])} commands have their options")


if __name__ == "__main__":
    main()
