"""What is no Python, or not quite: a problem with its line, and the rest of the file."""

import os
import pickle
import random
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cpu_time import growth
from rtron.sources.code import ir
from rtron.sources.code.frontends.python import lower_python
from rtron.sources.code.frontends.python.tokenizer import statements, tokenize

SAMPLE = """\
# -*- coding: utf-8 -*-
import rospy
class Node(object):
    def __init__(self, (a, b)):
        self.pub = rospy.Publisher('/a%d' % a, String, queue_size=0777L)
        print >>sys.stderr, `b`, ur"x\\d"
        try: exec "a" in b
        except Error, e:
            raise Other, 'x'
    def run(self):
        while not rospy.is_shutdown():
            self.pub.publish(f"{1:>3}", key=lambda (k, v): v)
"""


def lowered(text):
    return lower_python("f.py", text if isinstance(text, bytes) else text.encode())


def lines_of(unit):
    return [problem.line for problem in unit.problems]


def names(unit):
    return [made.definition.name for made in unit.body if isinstance(made, ir.Define)]


BROKEN = {
    "a = 1\nb = = 2\nc = 3\n": [2],
    "def f():\n    x = 1\n    y = (\ndef g():\n    pass\n": [3],
    "def f(:\n    x = 1\ndef g():\n    pass\n": [1],
    "def f():\n# nothing\ndef g():\n    pass\n": [1],
    "def f():\n    pass\n      x = 1\ndef g():\n    pass\n": [3],
    "def f():\n    if x =! 1:\n        y\n    z\ndef g():\n    pass\n": [2],
    "<<<<<<< HEAD\ndef f(): pass\n=======\n>>>>>>> x\ndef g(): pass\n": [1, 3, 4],
    "def f(): pass\nx = 'abc\ndef g(): pass\n": [2],
    "def f(): pass\nx = 99999999" + "9" * 5000 + "\ndef g(): pass\n": [2],
}


@pytest.mark.parametrize("text", BROKEN)
def test_one_broken_statement_does_not_lose_the_file(text):
    unit = lowered(text)
    assert sorted(lines_of(unit)) == BROKEN[text]
    if "def g" in text:
        assert "g" in names(unit)


def test_what_stands_around_a_broken_statement_keeps_its_line():
    unit = lowered("a = 1\nb = = 2\nc = 3\n")
    assert [statement.line for statement in unit.body] == [1, 3]
    assert "b" not in repr([statement.targets for statement in unit.body])


def test_a_broken_method_does_not_lose_its_class():
    unit = lowered("class K:\n    def f(self):\n        a b\n    def g(self):\n        pass\n")
    (define,) = unit.body
    assert [method.definition.name for method in define.definition.body] == ["f", "g"]
    assert lines_of(unit) == [3]


def test_an_unclosed_text_takes_what_is_behind_it_only():
    unit = lowered("def f(): pass\nx = '''abc\ndef g(): pass\n")
    assert names(unit) == ["f"]
    assert lines_of(unit) == [2]


def test_too_many_errors_leave_what_stands_before():
    unit = lowered("a = 1\n" + "b = = 2\n" * 1000 + "c = 3\n")
    assert unit.body[0] == ir.Assign(unit.body[0].targets, ir.Const(1), 1)
    assert 0 < len(unit.problems) <= 61


ENCODED = [
    ("é".encode(), "é", 0),
    (b"\xef\xbb\xbf'\xc3\xa9'", "é", 0),
    (b"# coding: latin-1\n'\xe9'", "é", 0),
    (b"#!/usr/bin/python\n# vim: set fileencoding=iso-8859-15 :\n'\xa4'", "€", 0),
    (b"# -*- coding: utf8-unix -*-\n'\xc3\xa9'", "é", 0),
    (b"# coding: nonsense\n'\xc3\xa9'", "é", 0),
    (b"# coding: punycode\n'\xc3\xa9'", "é", 0),
    (b"# coding: bz2\n'\xc3\xa9'", "é", 0),
    (b"x\n\n# coding: latin-1\n'\xc3\xa9'", "é", 0),
    (b"import x\n# coding: latin-1\n'\xc3\xa9'", "é", 0),
    (b"'\xe9'", "é", 1),
    (b"# coding: ascii\n'\xe9'", "é", 2),
    (b"\n\n'\xe9'", "é", 3),
]


@pytest.mark.parametrize(("data", "text", "line"), ENCODED)
def test_bytes_become_text_as_python_says(data, text, line):
    if not data.endswith(b"'"):
        data = b"'" + data + b"'"
    begin = data.rindex(b"'", 0, -1)
    unit = lowered(data[:begin] + b"a = " + data[begin:])
    assert unit.body[-1].value == ir.Const(text)
    assert lines_of(unit) == ([line] if line else [])


def test_nul_bytes_are_spaces():
    unit = lowered(b"a = 1\nb =\0 2\n")
    assert [statement.value for statement in unit.body] == [ir.Const(1), ir.Const(2)]
    assert unit.problems == (ir.SourceProblem(2, "NUL bytes"),)


@pytest.mark.parametrize(("more", "read"), [(0, True), (1, False)])
def test_a_large_file_is_not_read(more, read):
    unit = lowered(b"a = 1\n#" + b"x" * (2 * 2**20 - 7 + more))
    assert bool(unit.body) is read
    assert bool(unit.problems) is not read


DEEP = {
    "brackets": "a = " + "(" * 5000 + ")" * 5000,
    "lists": "a = " + "[" * 150 + "]" * 150,
    "signs": "a = " + "-" * 90_000 + "1",
    "nots": "a = " + "not " * 5000 + "1",
    "sum": "a = " + "+".join("1" * 1000),
    "long sum": "a = " + "+".join("1" * 90_000),
    "members": "a = b" + ".c" * 90_000,
    "calls": "a = b" + "()" * 5000,
    "lambdas": "a = " + "lambda: " * 5000 + "1",
    "blocks": "".join(f"{' ' * depth}if x:\n" for depth in range(99)) + " " * 99 + "x",
    "more blocks": "".join(f"{' ' * depth}if x:\n" for depth in range(500)) + " " * 500 + "x",
    "branches": "if x: y\n" + "elif x: y\n" * 5000,
    "annotation": "def f(a: " + "b[" * 150 + "]" * 150 + "): pass",
    "patterns": "match a:\n case " + "[" * 150 + "]" * 150 + ": pass",
    "text in text": "a = " + "f'{" * 150,
}


@pytest.mark.parametrize("kind", DEEP)
def test_nesting_is_bounded_and_the_rest_is_read(kind):
    unit = lowered(f"def f(): pass\n{DEEP[kind]}\ndef g(): pass\n")
    assert pickle.loads(pickle.dumps(unit)) == unit
    assert unit.problems or kind in ("blocks", "annotation", "patterns")
    assert {"f", "g"} <= set(names(unit)) or kind == "branches"


def test_an_expression_is_cut_at_a_hundred_levels():
    assert lowered("a = " + "+".join("1" * 90)).problems == ()
    cut = lowered("a = " + "+".join("1" * 110))
    assert lines_of(cut) == [1]
    assert "Opaque" in repr(cut.body)


def test_a_snippet_is_short():
    (statement,) = lowered("a = " + "9" * 500 + "j").body
    assert isinstance(statement.value, ir.Opaque)
    assert len(statement.value.text) == 60


HOSTILE = {
    "lambdas": ("a = 1 = ", "lambda (", ""),
    "tuples": ("a = 1 = ", "lambda (a, b): ", ""),
    "quotes": ("a = = '''", "\\'''", ""),
    "backslashes": ("a = = ", "\\", ""),
    "prints": ("", "print a;", "= ="),
    "errors": ("", "a b\n", ""),
    "colons": ("if ", "lambda:", ""),
    "backticks": ("`", "``", ""),
    "tabs": ("", "\t", "a b"),
}


def hostile(kind, size):
    """Return a file of about this size (characters) whose middle repeats."""
    begin, repeated, end = HOSTILE[kind]
    return begin + repeated * (size // len(repeated)) + end


@pytest.mark.parametrize("kind", HOSTILE)
def test_the_time_of_a_hostile_file_grows_with_its_size(kind):
    """Eight times the size takes about eight times as long, where its square takes 64."""
    units = []

    def read(text):
        units.append(lowered(text))

    assert growth(read, hostile(kind, 12_500), hostile(kind, 100_000)) < 32
    assert all(unit.problems for unit in units)


@given(st.binary(max_size=300))
def test_any_bytes_are_read(data):
    assert lowered(data).language is ir.SourceLanguage.PYTHON


@given(st.lists(st.sampled_from(SAMPLE.split(" ") + list("()[]{}:,;'\"`\n\t\\=")), max_size=60))
def test_any_words_are_read(words):
    assert lowered(" ".join(words)).language is ir.SourceLanguage.PYTHON


@pytest.mark.parametrize("seed", range(150))
def test_a_file_with_a_few_wrong_bytes_is_read(seed):
    chance = random.Random(seed)
    data = bytearray(SAMPLE.encode())
    for _ in range(chance.randrange(1, 6)):
        place = chance.randrange(len(data))
        data[place : place + chance.randrange(4)] = chance.randbytes(chance.randrange(3))
    unit = lowered(bytes(data))
    assert unit.body or unit.problems


def test_the_sample_is_read_whole():
    assert lowered(SAMPLE).problems == ()


@given(st.text(max_size=200))
def test_tokens_keep_order_and_place(text):
    tokens = list(tokenize(text))
    assert all(text[token.start : token.end] == token.text for token in tokens)
    assert all(before.end <= token.start for before, token in pairwise(tokens))
    kept = [token for tokens in statements(text) for token in tokens]
    assert kept == [token for token in tokens if token.text not in (";", "\n")]


def test_nothing_is_printed_of_what_python_warns_about(recwarn, capfd):
    assert lowered("a = '\\d'\nassert (a, 1)\nif a is 1: 1()\n").problems == ()
    assert not recwarn.list
    assert capfd.readouterr() == ("", "")


def python_files(root):
    for path in sorted(root.rglob("*")):
        if not path.is_file() or path.suffix not in ("", ".py"):
            continue
        data = path.read_bytes()
        if path.suffix or (data[:2] == b"#!" and b"python" in data.split(b"\n", 1)[0]):
            yield path, data


def test_real_apps_are_read():
    root = os.environ.get("RTRON_APPS")
    if not root:
        pytest.skip("RTRON_APPS names no folder of apps")
    units = [lower_python(str(path), data) for path, data in python_files(Path(root))]
    whole = sum(not unit.problems for unit in units)
    assert units
    assert whole >= 0.99 * len(units)
