#!/usr/bin/env python3
"""A header as Doxygen reads it: "//" before a declaration becomes "///", as text without commands.

    doxygen_filter.py HEADER

The comment at the head becomes that of the file. A comment at the end of a line belongs to what stands before
it ("///<"). Nothing else is changed, and lines keep their numbers.
"""

import pathlib
import re
import sys

NAME = "/".join(pathlib.PurePath(sys.argv[1]).parts[-2:])  # "sim/rays/trace.h", as it is included
COMMENT = re.compile(r"^(\s*)//(?!/)(.*)$")
TRAILING = re.compile(r"^(.*\S)\s\s*//\s(.*)$")


def escaped(text):
    """Text that Doxygen takes for text."""
    return re.sub(r"([\\@<>&$#%])", r"\\\1", text).replace('"', r"\"") if text else text


def filtered(lines):
    """The lines of a header, with Doxygen's comments."""
    out = []
    for line in lines:
        whole = COMMENT.match(line)
        trailing = TRAILING.match(line)
        if whole:
            indent, text = whole.groups()
            mark = f"/// \\file {NAME}" if not out else ""
            # Two blanks more are kept as they stand: formulas and tables.
            body = escaped(text.strip()) + ("<br>" if text.startswith("   ") else "")
            out.append(f"{mark or indent + '///'} {body}")
            continue
        if trailing and '"' not in trailing.group(1) and not line.lstrip().startswith("#"):
            out.append(f"{trailing.group(1)}  ///< {escaped(trailing.group(2))}")
        else:
            out.append(line)
    return out


with open(sys.argv[1], encoding="utf-8") as header:
    sys.stdout.write("\n".join(filtered(header.read().split("\n"))))
