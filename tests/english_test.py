"""The English of comments and identifiers: refuses patterns that a reader has to read twice, and long lines.

    english_test.py ROOT         checks the tree, one line a violation, status 1 if there are any
    english_test.py --self-test  shows on made-up sources that each rule holds
"""

import pathlib
import re
import sys
import tempfile

FOLDERS = ["apps", "calib", "core", "data_io", "metrics", "sim"]

SUFFIXES = (".h", ".cc")

# A line of nothing but comment, in these folders too. Python: "#".
MAX_COLUMNS = 110
ALSO_FOR_COLUMNS = ["scripts", "tests"]
COMMENT_LINE = {".h": re.compile(r"\s*//"), ".cc": re.compile(r"\s*//"), ".py": re.compile(r"\s*#")}

# A comment begins with a noun phrase or a verb.
OPENINGS = re.compile(r"(Of|What|The same|Where)\b")
IDENTIFIERS = re.compile(r"\bk(Most|Fewest)(?=[A-Z0-9]|\b)\w*")
WORDS = re.compile(r"\bwhoever\b", re.IGNORECASE)

# Comments and literals, so that a literal with "//" is no comment.
TOKENS = re.compile(
    r'(?P<comment>//[^\n]*)|R"(?P<mark>[^(\s"]*)\(.*?\)(?P=mark)"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'', re.DOTALL
)


def sources(root):
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in SUFFIXES:
                yield path.relative_to(root).as_posix(), path.read_text(encoding="utf-8")


def comments(text):
    """(line, text) of each block of comment lines and each comment behind code."""
    blocks = []
    last_line, last_column = None, None
    for match in TOKENS.finditer(text):
        if match["comment"] is None:
            continue
        line = text.count("\n", 0, match.start()) + 1
        column = match.start() - (text.rfind("\n", 0, match.start()) + 1)
        words = match["comment"].lstrip("/").strip()
        if last_line == line - 1 and last_column == column:
            blocks[-1] = (blocks[-1][0], f"{blocks[-1][1]} {words}")
        else:
            blocks.append((line, words))
        last_line, last_column = line, column
    return blocks


def faults(text):
    """(line, what is wrong) of a source."""
    found = []
    for line, comment in comments(text):
        opening = OPENINGS.match(comment)
        if opening:
            found.append((line, f"a comment begins with '{opening[0]}', expected a noun phrase or a verb"))
    for pattern, advice in ((IDENTIFIERS, "expected kMax or kMin"), (WORDS, "expected 'callers that'")):
        for match in pattern.finditer(text):
            found.append((text.count("\n", 0, match.start()) + 1, f"'{match[0]}', {advice}"))
    return sorted(found)


def long_lines(root):
    """Comment lines beyond the limit, one sentence each."""
    for folder in FOLDERS + ALSO_FOR_COLUMNS:
        for path in sorted((root / folder).rglob("*")):
            name = path.relative_to(root).as_posix()
            begins = COMMENT_LINE.get(path.suffix)
            if begins is None:
                continue
            for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
                if len(line) > MAX_COLUMNS and begins.match(line):
                    yield f"{name}:{number}: a comment of {len(line)} columns, expected {MAX_COLUMNS} or fewer"


def violations(root):
    found = [f"{name}:{line}: {fault}" for name, text in sources(root) for line, fault in faults(text)]
    return found + list(long_lines(root))


def is_violation(text):
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / FOLDERS[0] / "a.h"
        path.parent.mkdir()
        path.write_text(text + "\n", encoding="utf-8")
        return bool(violations(pathlib.Path(folder)))


def self_test():
    """Each text must or must not be a violation."""
    cases = [
        ("// Of a frame's random numbers.", True),
        ("// Random seeds of a frame.", False),
        ("// Offset of a frame.", False),
        ("  // What each ray met.", True),
        ("// The same in blocks of columns.", True),
        ("// The same seed gives the same image.", True),
        ("// Where there is none.", True),
        ("int cols = 0;  // Of a fan.", True),
        ("// Distance of a point.\n// Of all of them the nearest.", False),
        ("// Distance of a point.\n//\n// Of all of them the nearest.", False),
        ("int a;  // one\n// Of the next line.", True),
        ('const char* text = "// Of nothing";', False),
        ('const char* text = R"(\n// Of nothing\n)";', False),
        ("constexpr int kMostFrames = 3;", True),
        ("constexpr int kMost = 3;", True),
        ("constexpr int kFewestFrames = 3;", True),
        ("constexpr int kMostly = 3;", False),
        ("constexpr int kMaxFrames = 3;", False),
        ("// For whoever calls it.", True),
        ("// " + 107 * "x", False),
        ("// " + 108 * "x", True),
        ("  // " + 106 * "x", True),
        ("int a = 0;" + 101 * " ", False),
    ]
    return [
        f"{text!r}: expected {'a' if expected else 'no'} violation"
        for text, expected in cases
        if is_violation(text) != expected
    ]


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    if sys.argv[1] == "--self-test":
        found = self_test()
    else:
        root = pathlib.Path(sys.argv[1])
        found = violations(root)
        if not any(True for _ in sources(root)):
            found = [f"{root}: no sources, expected the folders {', '.join(FOLDERS)}"]
    for line in found:
        print(line)
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
