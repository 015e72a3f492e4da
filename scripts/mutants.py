"""Finds mutants of the formulas in the sources and writes sources that hold all of them. Needs python3-clang.

A mutant is one small change of a formula: + to -, * to /, < to <=, == to !=, && to ||, a number to its double (0
to 1), a sign or a negation left out, a returned condition turned round. Every mutant is in the same build:
scripts/mutant.h selects one by an environment variable when a program runs.

Left alone is what must be constant (constexpr, static_assert, enumerators, array bounds, template arguments,
default member initialisers), what only makes messages, and sizes in reserve(). scripts/mutation_test.py uses this
file.
"""

import concurrent.futures
import pathlib
import re

from clang import cindex
from clang.cindex import CursorKind, TypeKind

PLACES = ["sim/physics", "metrics", "calib/models/power_likelihood.h", "calib/models/power_likelihood.cc"]
FLAGS = ["-xc++", "-std=c++20", "-isystem/usr/include/eigen3", "-isystem/usr/include/opencv4"]
INCLUDE = '#include "scripts/mutant.h"\n'

BINARY = {
    "+": ("Plus", "-"), "-": ("Minus", "+"), "*": ("Times", "/"), "/": ("Over", "*"),
    "<": ("Less", "<="), "<=": ("LessEqual", "<"), ">": ("Greater", ">="), ">=": ("GreaterEqual", ">"),
    "==": ("Equal", "!="), "!=": ("NotEqual", "=="), "&&": ("", "||"), "||": ("", "&&"),
    "+=": ("AddTo", "-="), "-=": ("TakeFrom", "+="), "*=": ("Scale", "/="), "/=": ("Divide", "*="),
}
FUNCTIONS = {
    CursorKind.FUNCTION_DECL, CursorKind.FUNCTION_TEMPLATE, CursorKind.CXX_METHOD, CursorKind.CONSTRUCTOR,
    CursorKind.DESTRUCTOR, CursorKind.CONVERSION_FUNCTION, CursorKind.VAR_DECL,
}
CONSTANT = {
    CursorKind.FIELD_DECL, CursorKind.STATIC_ASSERT, CursorKind.ENUM_DECL, CursorKind.TYPE_ALIAS_DECL,
    CursorKind.TYPE_ALIAS_TEMPLATE_DECL, CursorKind.TEMPLATE_TYPE_PARAMETER,
    CursorKind.TEMPLATE_NON_TYPE_PARAMETER, CursorKind.CXX_THROW_EXPR,
}
LITERALS = {CursorKind.INTEGER_LITERAL, CursorKind.FLOATING_LITERAL}
MESSAGES = {"format", "print", "reserve", "to_string"}
# Pointers and classes are no formulas. Dependent: a template on the scalar type.
NUMBERS = {
    TypeKind.BOOL, TypeKind.UCHAR, TypeKind.CHAR_S, TypeKind.SCHAR, TypeKind.SHORT, TypeKind.USHORT, TypeKind.INT,
    TypeKind.UINT, TypeKind.LONG, TypeKind.ULONG, TypeKind.LONGLONG, TypeKind.ULONGLONG, TypeKind.FLOAT,
    TypeKind.DOUBLE, TypeKind.ENUM, TypeKind.DEPENDENT, TypeKind.UNEXPOSED,
}


def is_number(cursor):
    return cursor.type.get_canonical().kind in NUMBERS


def span(cursor):
    return cursor.extent.start.offset, cursor.extent.end.offset


class Finder:
    """Mutants of some files, as edits: (offset, characters to replace, new text)."""

    def __init__(self, texts):
        self.texts, self.text, self.path, self.found, self.seen = texts, "", "", [], set()

    def add(self, cursor, change, edits):
        start, end = span(cursor)
        if (self.path, start, end, change) in self.seen:
            return
        self.seen.add((self.path, start, end, change))
        source = " ".join(self.text[start:end].split())
        self.found.append({"file": self.path, "line": self.text.count("\n", 0, start) + 1, "change": change,
                           "source": source, "start": start, "end": end, "edits": edits})

    def is_constant(self, cursor):
        if cursor.kind in CONSTANT:
            return True
        if cursor.kind == CursorKind.CALL_EXPR:
            return cursor.spelling in MESSAGES or "Error" in cursor.spelling
        if cursor.kind not in FUNCTIONS:
            return False
        start, end = span(cursor)
        text = self.texts[cursor.location.file.name]
        return re.search(r"\bconst(expr|eval|init)\b", re.split(r"[({=]", text[start:end])[0]) is not None

    def walk(self, cursor):
        for child in cursor.get_children():
            file = child.location.file
            if file is None or file.name not in self.texts or self.is_constant(child):
                continue
            self.path, self.text = file.name, self.texts[file.name]
            self.visit(child, cursor)
            self.walk(child)

    def visit(self, cursor, parent):
        start, end = span(cursor)
        operands = list(cursor.get_children())
        text = self.text[start:end]
        if cursor.kind in (CursorKind.BINARY_OPERATOR, CursorKind.COMPOUND_ASSIGNMENT_OPERATOR):
            if len(operands) == 2 and all(map(is_number, operands)):
                self.binary(cursor, *operands)
        elif cursor.kind == CursorKind.UNARY_OPERATOR and len(operands) == 1 and is_number(operands[0]):
            name = {"-": "Negative", "!": "Not"}.get(text[:1])
            # clang gives x != y by a rewritten == as a negation at "!=".
            if name and not text.startswith(("--", "!=")):
                self.add(cursor, f"without {text[:1]}",
                         [(start, 1, f"mutation::{name}({{id}}, "), (end, 0, ")")])
        elif cursor.kind in LITERALS and re.fullmatch(r"[0-9.][0-9a-fA-FxXeE.'+uUlLzZ-]*", text):
            if parent.kind not in FUNCTIONS or self.text[:start].rstrip()[-1:] in ("=", "(", "{", ","):
                zero = float(re.sub("[uUlLzZfF']", "", text) if "x" not in text else "1") == 0.0
                self.add(cursor, "1" if zero else f"2 * {text}", self.call(start, end, "Number"))
        elif cursor.kind == CursorKind.RETURN_STMT and operands:
            if operands[0].type.get_canonical().kind == TypeKind.BOOL:
                self.add(operands[0], "turned round", self.call(*span(operands[0]), "Result"))

    @staticmethod
    def call(start, end, name):
        return [(start, 0, f"mutation::{name}({{id}}, "), (end, 0, ")")]

    def binary(self, cursor, left, right):
        between = self.text[span(left)[1]:span(right)[0]]
        operator = between.strip()
        if operator not in BINARY:
            return
        name, mutated = BINARY[operator]
        at = span(left)[1] + between.index(operator)
        start, end = span(cursor)
        if name:
            edits = [(start, 0, f"mutation::{name}({{id}}, "), (at, len(operator), ","), (end, 0, ")")]
        else:  # a && b is (a ? b : false), a || b is (!a ? b : true)
            stop = "false" if operator == "&&" else "true"
            one = f"(mutation::Active({{id}}) != {stop})"
            edits = [(start, 0, "(static_cast<bool>("), (at, len(operator), f") != {one} ? static_cast<bool>("),
                     (end, 0, f") : {one})")]
        self.add(cursor, f"{operator} to {mutated}", edits)


def rewritten(text, mutants):
    """Text with all mutants. Outer ones open first and close last."""
    edits = []
    for m in mutants:
        size = m["end"] - m["start"]
        for index, (offset, length, new) in enumerate(m["edits"]):
            closes = index == len(m["edits"]) - 1
            order = (0, size, -m["id"]) if closes else (1, -size, m["id"])
            mark = f"/*:{m['id']}*/" if closes else f"/*{m['id']}:*/" if index == 0 else ""
            edits.append((offset, order, length, mark + new.format(id=m["id"]) if index == 0 or not closes
                          else new.format(id=m["id"]) + mark))
    pieces, at = [INCLUDE], 0
    for offset, _, length, new in sorted(edits):
        pieces += [text[at:offset], new]
        at = offset + length
    return "".join(pieces + [text[at:]])


def mutants_at(text, offset):
    """Numbers of the mutants around an offset of a rewritten text, innermost last."""
    open_ones = []
    for mark in re.finditer(r"/\*(:?)(\d+)(:?)\*/", text[:offset]):
        if mark[3]:
            open_ones.append(int(mark[2]))
        else:
            open_ones.remove(int(mark[2]))
    return open_ones


def found_in(root, files):
    """Mutants of some files of one translation unit."""
    finder = Finder({str(root / file): (root / file).read_text(encoding="ascii") for file in files})
    unit = str(root / "mutants_unit.cc")
    includes = "".join(f'#include "{file}"\n' for file in files)
    parsed = cindex.Index.create().parse(unit, args=FLAGS + [f"-I{root}"], unsaved_files=[(unit, includes)])
    errors = [str(d) for d in parsed.diagnostics if d.severity >= cindex.Diagnostic.Error]
    if errors:
        raise RuntimeError(errors[0])
    finder.walk(parsed.cursor)
    return finder.found


def all_mutants(root):
    """Mutants of all places, numbered, in the order of files and lines. Their files are relative to `root`."""
    root = pathlib.Path(root).resolve()
    files = [f for place in PLACES for f in ([root / place] if "." in place else sorted((root / place).rglob("*")))]
    files = [f.relative_to(root).as_posix() for f in files if f.suffix in (".h", ".cc")]
    units = [[f for f in files if f.endswith(".h")]] + [[f] for f in files if f.endswith(".cc")]
    with concurrent.futures.ProcessPoolExecutor(2) as pool:
        found = [m for of_unit in pool.map(found_in, [root] * len(units), units) for m in of_unit]
    for mutant in found:
        mutant["file"] = pathlib.Path(mutant["file"]).relative_to(root).as_posix()
    found.sort(key=lambda m: (m["file"], m["start"], -m["end"]))
    for number, mutant in enumerate(found):
        mutant["id"] = number
    return files, found


def write(root, folder, files, mutants):
    """Writes files of `root` with these mutants into a folder. Leaves alone what is already there."""
    for file in files:
        changed = rewritten((root / file).read_text(encoding="ascii"), [m for m in mutants if m["file"] == file])
        target = folder / file
        if not target.exists() or target.read_text(encoding="ascii") != changed:
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(changed, encoding="ascii")
