"""Python 2 is read as what it means; no line moves."""

import ast

import pytest

from rtron.sources.code import ir
from rtron.sources.code.frontends.python import lower_python
from rtron.sources.code.frontends.python.python2_syntax import as_python3

SAME = [
    ("print", "print()"),
    ("print 'a'", "print('a')"),
    ("print 'a', b", "print('a', b)"),
    ("print 'a',", "print('a',)"),
    ("print (a), b", "print((a), b)"),
    ("print (a) % b", "print((a) % b)"),
    ("print (a)", "print(a)"),
    ("print '%d' % x  # why", "print('%d' % x)"),
    ("print >>f, x, y", "print(x, y, file=f)"),
    ("print >>f", "print(file=f)"),
    ("print >>f.g(1, 2), x,", "print(x, file=f.g(1, 2))"),
    ("print a; print b", "print(a); print(b)"),
    ("if a: print b", "if a: print(b)"),
    ("if a[1:2]: print lambda: b", "if a[1:2]: print(lambda: b)"),
    ("if lambda: a: print b", "if (lambda: a): print(b)"),
    ("exec a", "exec(a)"),
    ("exec 'a%s' % b in c", "exec('a%s' % b, c)"),
    ("exec a in b, c", "exec(a, b, c)"),
    ("try: a\nexcept E, e: b", "try: a\nexcept E as e: b"),
    ("try: a\nexcept E,e: b", "try: a\nexcept E as e: b"),
    ("try: a\nexcept E ,e:b", "try: a\nexcept E  as e:b"),
    ("try: a\nexcept E,\\\n e: b", "try: a\nexcept E as\\\n e: b"),
    ("try: a\nexcept (E, F), e: b", "try: a\nexcept (E, F) as e: b"),
    ("try: a\nexcept E, (m, n): b", "try: a\nexcept E: b"),
    ("raise E, 'x'", "raise E('x')"),
    ("raise E, 'x', t", "raise E('x', t)"),
    ("a = `b + 1` + `c`", "a = repr(b + 1) + repr(c)"),
    ("print `a`", "print(repr(a))"),
    ("a <> b", "a != b"),
    ("a = 0777, 00L, 0x1FL, 123L, 0", "a = 0o777, 0, 0x1f, 123, 0"),
    ("a = ur'b\\d'", "a = r'b\\d'"),
    ("a = 'C:\\users', u'\\u00e9'; print a", "a = 'C:\\\\users', u'\\u00e9'; print(a)"),
    ("a = lambda (b, c): b", "a = lambda T: (lambda b, c: (b))(*T)"),
    ("a = lambda (b): b; print a", "a = lambda b: b; print(a)"),
    ("f(lambda x, (b, c), y=1: b, 2)", "f(lambda x, T, y=1: (lambda b, c: (b))(*T), 2)"),
    ("a = lambda ((b, c), d): b", "a = lambda T: (lambda U, d: ((lambda b, c: (b))(*U)))(*T)"),
    (
        "[f for f in (lambda (a, b): a for b in c)]",
        "[f for f in (lambda T: (lambda a, b: (a))(*T) for b in c)]",
    ),
    ("f(async=1); print a", "f(async_=1); print(a)"),
    ("if a:\n\tprint b\n        print c", "if a:\n        print(b)\n        print(c)"),
    ("a = '''\n\tprint b\n'''; print c", "a = '''\n\tprint b\n'''; print(c)"),
    ("print 'print x', \"a # b\"", "print('print x', \"a # b\")"),
    ("print (a,\n  b), c\nprint d", "print((a,\n  b), c)\nprint(d)"),
    ("print >>(\n f), a\nb", "print(\na, file=( f))\nb"),
    ("print \\\n a\nb", "print( \\\n a)\nb"),
]


def lines(text, names=()):
    """Dump a text's lowered form, invented names aside."""
    unit = lower_python("f.py", text.encode())
    assert unit.problems == ()
    shown = repr(unit.body)
    for tree in ast.walk(ast.parse(as_python3(as_python3(text)))):
        name = getattr(tree, "arg", None) or ""
        if name.startswith("_tuple_") and name not in names:
            names = (*names, name)
    for name, short in zip(names, "TUV", strict=False):
        shown = shown.replace(repr(name), repr(short))
    return shown


@pytest.mark.parametrize(("old", "new"), SAME)
def test_python_2_means_what_python_3_says(old, new):
    assert lines(f"{old}\nprint 2") == lines(f"{new}\nprint(2)")


def test_a_tuple_among_parameters_is_taken_apart():
    (define,) = lower_python("f.py", b"def f(a, (b, (c, d)), e=1):\n  print b\n").body
    names = [param.name for param in define.definition.params]
    inner = ir.SequenceExpr((ir.Name("c"), ir.Name("d")), "tuple")
    assert names[0::2] == ["a", "e"]
    assert define.definition.body[0] == ir.Assign(
        (ir.SequenceExpr((ir.Name("b"), inner), "tuple"),), ir.Name(names[1]), 1
    )


def test_a_bracketed_parameter_is_a_plain_one():
    (define,) = lower_python("f.py", b"def f((a)): pass\n").body
    assert [param.name for param in define.definition.params] == ["a"]


def test_python_3_is_left_as_it_is():
    text = "def f(a: (b, c), *d):\n    print(a, b)\n    print()\n    raise E('x') from c\n"
    assert as_python3(text) == text


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_lines_stay_where_they_are(end):
    text = end.join(["print 1", "print '''", "'''", "print >>f, \\", " x", "a = 1"])
    unit = lower_python("f.py", text.encode())
    assert unit.problems == ()
    assert [statement.line for statement in unit.body] == [1, 2, 4, 6]
