"""API pages in Markdown from the XML that Doxygen makes of include/rubble: a page for each header."""
import html
import pathlib
import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ET

SETTINGS = """INPUT={source}
FILE_PATTERNS=*.h
OUTPUT_DIRECTORY={folder}
GENERATE_HTML=NO
GENERATE_LATEX=NO
GENERATE_XML=YES
EXTRACT_ALL=YES
MACRO_EXPANSION=YES
EXPAND_ONLY_PREDEF=YES
PREDEFINED=RUBBLE_HD=
WARNINGS=NO
QUIET=YES
"""


def text_of(element):
    """A description as one line of Markdown."""
    if element is None:
        return ""
    parts = [element.text or ""]
    for child in element:
        inner = text_of(child)
        parts.append(f"`{inner}`" if child.tag == "computeroutput" else inner)
        parts.append(child.tail or "")
    return re.sub(r"\s+", " ", "".join(parts)).strip()


def doc_of(member):
    parts = (text_of(member.find(f"{kind}description")) for kind in ("brief", "detailed"))
    return " ".join(filter(None, parts))


def plain(element):
    return html.unescape("".join(element.itertext())).strip() if element is not None else ""


def signature(member):
    name = plain(member.find("name"))
    if member.get("kind") == "enum":
        return f"enum class {name}"
    result = plain(member.find("type"))
    start = plain(member.find("initializer"))
    return f"{result} {name}{plain(member.find('argsstring'))}{' ' + start if start else ''}".strip()


def cell(text):
    return text.replace("|", "\\|")


def members(compound):
    """Markdown of a struct, class or file: values as a table, functions by their signatures."""
    lines, values = [], []
    found = [member for member in compound.iter("memberdef")
             if member.get("prot") == "public" and not plain(member.find("name")).startswith("@")]
    for member in found:
        if member.get("kind") == "variable":
            values.append(f"| `{cell(signature(member))}` | {cell(doc_of(member))} |")
    if values:
        lines += ["| Member | Meaning |", "|---|---|", *values, ""]
    for member in found:
        if member.get("kind") in ("function", "typedef"):
            lines += ["```cpp", signature(member), "```", ""]
            if doc_of(member):
                lines += [doc_of(member), ""]
        elif member.get("kind") == "enum":
            lines += [f"### {plain(member.find('name'))}", "", doc_of(member), ""]
            lines += ["| Value | Meaning |", "|---|---|"]
            lines += [f"| `{plain(value.find('name'))}` | {cell(doc_of(value))} |"
                      for value in member.findall("enumvalue")]
            lines.append("")
    return lines


def page(header, compounds, of_file):
    text = header.read_text(encoding="utf-8")
    lead = re.search(r"#pragma once\n((?:/// ?.*\n)+)", text)
    lines = [f"# rubble/{header.name}", "", re.sub(r"^/// ?", "", lead.group(1), flags=re.M) if lead else ""]
    for compound in compounds:
        name = plain(compound.find("compoundname")).removeprefix("rubble::")
        lines += [f"## {name}", "", doc_of(compound), "", *members(compound)]
    if of_file:
        lines += ["## Functions and types", "", *of_file]
    return re.sub(r"\n{3,}", "\n\n", "\n".join(lines)) + "\n"


def header_of(element):
    return pathlib.Path(element.find("location").get("file")).name


def write(source, work, target):
    """Writes pages of the headers in `source` to `target` and returns their paths. Exits without Doxygen."""
    if not shutil.which("doxygen"):
        sys.exit("make_docs: pages of the API need Doxygen (apt-get install doxygen)")
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    settings = work / "Doxyfile"
    settings.write_text(SETTINGS.format(source=source, folder=work), encoding="utf-8")
    subprocess.run(["doxygen", str(settings)], check=True, capture_output=True)
    by_header, files = {}, {}
    for path in sorted((work / "xml").glob("*.xml")):
        for compound in ET.parse(path).getroot().iter("compounddef"):
            if compound.get("kind") in ("struct", "class"):
                by_header.setdefault(header_of(compound), []).append(compound)
            elif compound.get("kind") == "namespace":
                for member in compound.iter("memberdef"):
                    files.setdefault(header_of(member), []).append(member)
    pages = []
    for header in sorted(source.glob("*.h")):
        compounds = by_header.get(header.name, [])
        compounds.sort(key=lambda compound: int(compound.find("location").get("line")))
        root = ET.Element("compounddef")
        root.extend(files.get(header.name, []))
        for member in root:
            member.set("prot", "public")
        pages.append(target / (header.stem + ".md"))
        pages[-1].parent.mkdir(parents=True, exist_ok=True)
        pages[-1].write_text(page(header, compounds, members(root)), encoding="utf-8")
    return pages
