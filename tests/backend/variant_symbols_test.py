"""The object of an instruction set defines one function for others, and shares variables alone.

Usage: variant_symbols_test.py OBJECT NM OBJDUMP ENTRY

A weak function or vtable of it could be linked for everybody, and stop a processor that lacks the
instructions.
A variable of its own would be one that other objects do not see.
"""

import subprocess
import sys
import unittest

OBJECT, NM, OBJDUMP, ENTRY = sys.argv[1:]
WRITABLE = (".data", ".bss", ".tdata", ".tbss")


def lines(*command: str) -> list[str]:
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()


def symbols() -> list[dict[str, str]]:
    """Defined symbols: name, class (a small letter: local; W, V, u: weak or unique) and section."""
    out = []
    for line in lines(NM, "--format=sysv", "--defined-only", OBJECT):
        parts = [part.strip() for part in line.split("|")]
        if len(parts) == 7:
            out.append({"name": parts[0], "class": parts[2], "type": parts[3], "section": parts[6]})
    return out


def isWritable(section: str) -> bool:
    return section.startswith(WRITABLE) and not section.startswith(".data.rel.ro")


class VariantSymbols(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.symbols = symbols()
        cls.shared = [s for s in cls.symbols if s["class"] in "TWVuDBRSGC"]

    def test_one_function_is_global(self) -> None:
        self.assertGreater(len(self.symbols), 1000)
        functions = [s for s in self.shared if s["type"] == "FUNC" or s["section"].startswith(".text")]
        self.assertEqual([ENTRY in s["name"] for s in functions], [True], functions)

    def test_other_global_symbols_are_variables(self) -> None:
        for symbol in self.shared:
            if ENTRY not in symbol["name"]:
                self.assertTrue(isWritable(symbol["section"]), symbol)

    def test_inline_variables_are_shared(self) -> None:
        # names of C++ that are local though writable belong to this object alone: there are none of ours
        for symbol in self.symbols:
            if symbol["name"].startswith("_ZN6rubble") and isWritable(symbol["section"]):
                self.assertIn(symbol, self.shared)

    def test_no_group_is_merged_by_its_name(self) -> None:
        sections = lines(OBJDUMP, "-h", OBJECT)
        self.assertFalse([line for line in sections if "LINK_ONCE" in line or "GROUP" in line])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
