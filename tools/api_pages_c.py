"""API pages in Markdown from include/rubble/c: a page for each header. It needs nothing but Python."""
import re

LEAD = re.compile(r"#pragma once\n((?:/// ?.*\n)+)")
# A comment above, and the declaration that it belongs to up to its end.
ITEM = re.compile(r"((?:^///[^\n]*\n)*)^(typedef (?:enum|struct) \w+ \{\n.*?^\} \w+;|RB_API [^;]*;"
                  r"|typedef struct \w+ \w+;|#define RB_\w+ \d[^\n]*$)", re.M | re.S)
FIELD = re.compile(r"^((?:  ///.*\n)*)  ([^/\n]+?)[;,]?(?:\s*///< (.*(?:\n\s*///< .*)*))?$", re.M)


def text_of(comment):
    return re.sub(r"\s+", " ", re.sub(r"^\s*///<? ?", "", comment, flags=re.M)).strip()


def cell(text):
    return text.replace("|", "\\|")


def as_code(declaration):
    return re.sub(r"\s+", " ", declaration.removeprefix("RB_API ").strip())


def fields(body):
    """Rows of a table: values of an enum, members of a struct."""
    for above, declared, beside in FIELD.findall(body):
        meaning = text_of(above) or text_of(beside)
        yield f"| `{cell(declared.strip())}` | {cell(meaning)} |"


def page(name, text):
    """The page of a header: its values and structs, then its functions."""
    lead = LEAD.search(text)
    lines = [f"# rubble/c/{name}", "", text_of(lead.group(1)) if lead else "", ""]
    types, handles, values, calls = [], [], [], []
    body = text[lead.end():] if lead else text
    for comment, declared in ITEM.findall(body):
        meaning = text_of(comment)
        found = re.match(r"typedef (enum|struct) (\w+) \{\n(.*)^\}", declared, re.S | re.M)
        if found:
            kind, title, inner = found.groups()
            head = f"| {'Value' if kind == 'enum' else 'Member'} | Meaning |"
            types += [f"## {title}", "", meaning, "", head, "|---|---|", *fields(inner), ""]
        elif declared.startswith("typedef struct"):
            handles.append(f"`{declared.split()[-1].rstrip(';')}`")
        elif declared.startswith("#define"):
            _, title, value = declared.split(None, 2)
            values.append(f"| `{title}` | `{cell(value.split('//')[0].strip())}` | {cell(meaning)} |")
        elif meaning or not calls or calls[-1][0]:
            calls.append((meaning, [as_code(declared)]))
        else:
            calls[-1][1].append(as_code(declared))
    if values:
        lines += ["| Constant | Value | Meaning |", "|---|---|---|", *values, ""]
    if handles:
        lines += ["## Handles", "", "Opaque objects: " + ", ".join(handles) + ".", ""]
    lines += types
    if calls:
        lines += ["## Functions", ""]
        for meaning, declared in calls:
            lines += ["```c", *declared, "```", "", meaning, ""]
    return re.sub(r"\n{3,}", "\n\n", "\n".join(lines)).rstrip() + "\n"


def names(text):
    """All functions and types that a header declares."""
    patterns = r"RB_API [\w \*]+?\b(rb_\w+)\(", r"^\} (rb_\w+);", r"^typedef struct rb_\w+ (rb_\w+);"
    return {name for pattern in patterns for name in re.findall(pattern, text, re.M)}


def write(source, target):
    """Writes a page for each header in `source` to `target`, and returns their paths."""
    target.mkdir(parents=True, exist_ok=True)
    pages = []
    for header in sorted(source.glob("*.h")):
        pages.append(target / (header.stem + ".md"))
        pages[-1].write_text(page(header.name, header.read_text(encoding="utf-8")), encoding="utf-8")
    return pages
