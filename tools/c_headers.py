"""What the checks of the C interface read from include/rubble/c/*.h."""
import re

COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
ENUM = re.compile(r"typedef enum (\w+) \{(.*?)\} \w+;", re.DOTALL)
STRUCT = re.compile(r"typedef struct (\w+) \{(.*?)\} \w+;", re.DOTALL)
FUNCTION = re.compile(r"RB_API ([^;(]+\([^)]*\));")
VERSION = re.compile(r"#define RB_API_VERSION (\d+)")


def words(text):
    """Text with one space between words."""
    return re.sub(r"\s+", " ", text).strip()


class Headers:
    def __init__(self, root):
        self.files = sorted((root / "include/rubble/c").glob("*.h"))
        texts = [COMMENT.sub("", file.read_text(encoding="utf-8")) for file in self.files]
        self.version = int(next(found[1] for found in map(VERSION.search, texts) if found))
        self.constants = [(name, value, enum) for text in texts for enum, body in ENUM.findall(text)
                          for name, value in re.findall(r"(\w+) = (-?\w+)", body)]
        self.structs = [(name, words(body)) for text in texts for name, body in STRUCT.findall(text)]
        self.functions = [words(found) for text in texts for found in FUNCTION.findall(text)]
