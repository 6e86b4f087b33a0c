"""Syntax of Python 3.12 becomes what older parsers read, on the same lines."""

import ast
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cpu_time import work_units
from rtron.sources.code.frontends.python.python312_syntax import as_python311

REWRITTEN = {
    "f'{a['b']}/{c}'": "f'''{a['b']}/{c}'''",
    'f"{a["b"]}"': 'f"""{a["b"]}"""',
    "x = 'p' f'{a['b']}' 'q'": "x = 'p' f'''{a['b']}''' 'q'",
    "f'{f'{a}'}'": "f'''{f'{a}'}'''",
    "f'{f'{a['b']}'}'": "f'''{f\"\"\"{a['b']}\"\"\"}'''",
    "f'{{{a['b']}}}'": "f'''{{{a['b']}}}'''",
    "f'{a['b']:>{w['n']}}'": "f'''{a['b']:>{w['n']}}'''",
    "f'{ {'k': 1}['k'] }'": "f'''{ {'k': 1}['k'] }'''",
    "rF'{a['b']}\\d'": "rF'''{a['b']}\\d'''",
    "def f[T](a: T) -> T: pass": "def f(a: T) -> T: pass",
    "async def f[T: (int, str)](a): pass": "async def f(a): pass",
    "class A[T, *U](B[T]): pass": "class A(B[T]): pass",
    "type X = int": "X = int",
    "type X[T] = list[T]": "X = list[T]",
}
UNCHANGED = [
    "f'{a[\"b\"]}'",
    "f'''{a['b']}'''",
    "f'{{a['",
    "'{a['b']}'",
    "# f'{a['b']}'\nx = 1",
    "type(x)",
    "type = 3",
    "type.x = 3",
    "x = a[0]",
    "f'it''s {a}'",
    "'''\nf'{a['\n'''",
    "f'\\'{a}'",
]


@pytest.mark.parametrize(("text", "expected"), REWRITTEN.items(), ids=REWRITTEN)
def test_what_is_new_is_rewritten(text, expected):
    assert as_python311(text) == expected
    tree = ast.parse(expected)
    if sys.version_info >= (3, 12) and "[T" not in text:
        assert ast.dump(ast.parse(text.removeprefix("type "))) == ast.dump(tree)


@pytest.mark.parametrize("text", UNCHANGED)
def test_what_is_older_stays(text):
    assert as_python311(text) == text


@given(st.text("f'\"{}[]()#\\\n :abrtype=", max_size=40))
def test_any_text_keeps_its_lines(text):
    assert as_python311(text).count("\n") == text.count("\n")


def test_a_long_text_takes_no_time():
    text = "f'{a['b']}' " * 20_000 + "f'{" * 20_000
    rewritten, units = work_units(as_python311, text)
    assert rewritten.startswith("f'''")
    assert units < 20
