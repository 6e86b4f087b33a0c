"""Statements of C++ and Python, lowered: what each becomes stands behind it in `lowered/`.

A line is a source, `=>`, and its statements, which `; ` parts; `¶` is a new line of the source. A
node is spelled as `spelled` does it, with its line where that is not the first. After a change,
`python test_lowering.py` writes what the sources become now: read the difference.
"""

from dataclasses import MISSING, fields, is_dataclass
from enum import Enum
from pathlib import Path

import pytest

from rtron.sources.code import ir
from rtron.sources.code.frontends.cpp import lower_cpp
from rtron.sources.code.frontends.python import lower_python

FILES = sorted((Path(__file__).parent / "lowered").glob("*.txt"))


def lowered(language, source):
    """Return the statements that a source becomes, and the line on which it begins."""
    if language == "python":
        unit, first = lower_python("f.py", f"{source}\n".encode()), 1
        body = unit.body
    else:
        unit, first = lower_cpp("f.cpp", f"void f() {{\n{source}\n}}".encode(), {}), 2
        (function,) = unit.functions
        body = function.body
    assert unit.problems == ()
    return body, first


def spelled(node, first):
    """Return a node's text: names and operators as they are written, the rest by its class."""

    def of(value):
        return spelled(value, first)

    match node:
        case tuple():
            return f"[{', '.join(map(of, node))}]"
        case ir.Name(id, ()) | ir.TypeRef(id, ()):
            text = id
        case ir.Const(value):
            text = repr(value)
        case ir.Evaluate(value):
            text = of(value)
        case ir.Attr(owner, name, ()):
            text = f"{of(owner)}.{name}"
        case ir.Index(owner, key):
            text = f"{of(owner)}[{of(key)}]"
        case ir.Binary(sign, left, right):
            text = f"({of(left)} {sign} {of(right)})"
        case _ if is_dataclass(node):
            said = [prefix + of(getattr(node, name)) for name, prefix in parts(node)]
            text = f"{type(node).__name__}({', '.join(said)})"
        case _:
            return node.name if isinstance(node, Enum) else repr(node)
    line = getattr(node, "line", 0)
    return text if line in (0, first) else f"{text}@{line}"


def parts(node):
    """Yield the fields of a node that say something, and what stands before their values."""
    for each in fields(node):
        is_said = each.default is MISSING or getattr(node, each.name) != each.default
        if is_said and each.name not in ("line", "file"):
            yield each.name, "" if each.default is MISSING else f"{each.name}="


def line_of(language, source):
    body, first = lowered(language, source.replace("¶", "\n"))
    return f"{source} => {'; '.join(spelled(each, first) for each in body)}".rstrip()


def lines_of(file):
    """Yield each line of a file with its language and source."""
    for line in file.read_text().splitlines():
        yield file.stem.partition("_")[0], line.partition(" =>")[0], line


@pytest.mark.parametrize(
    ("language", "source", "line"), [each for file in FILES for each in lines_of(file)]
)
def test_a_statement_becomes_what_stands_behind_it(language, source, line):
    assert line_of(language, source) == line


if __name__ == "__main__":
    for file in FILES:
        lines = [line_of(language, source) for language, source, _ in lines_of(file)]
        file.write_text("\n".join([*lines, ""]))
