"""Lists and strings in the order and form that Python itself gives them."""

import pytest
from ros1_runs import names, python

LISTS = [
    "a = ['b', 'a']; a.sort(); x = a[0]",
    "a = ['b', 'c', 'a']; a.sort(reverse=True); x = a[0]",
    "a = ['bb', 'a']; a.sort(key=len); x = a[0]",
    "a = [10, 9]; x = 'n%d' % sorted(a)[0]",
    "x = sorted(['bb', 'a', 'ccc'], key=len)[1]",
    "x = sorted(['x1', 'w2', 'v0'], key=lambda s: s[1])[0]",
    "x = sorted({'k': 'v', 'a': 'z'}.items())[0][1]",
    "x = sorted({'k': 'v', 'a': 'z'}.items(), key=lambda p: p[1], reverse=True)[0][0]",
    "a = ['q', 'r']; a.reverse(); x = a[0]",
    "a = ['q', 'r']; a.insert(0, 'i'); x = '_'.join(a)",
    "a = ['q', 'r']; a.insert(-1, 'i'); x = '_'.join(a)",
    "import collections; a = collections.deque(['q']); a.appendleft('p'); x = '_'.join(a)",
    "a = ['q', 'r', 's']; a[1:3] = ['t']; x = '_'.join(a)",
    "a = ['q', 'r', 's', 't']; a[::2] = ['u', 'v']; x = '_'.join(a)",
    "a = ['q', 'r', 's']; del a[1:]; x = '_'.join(a)",
    "a = set(['k']); a.update(['l']); x = 'n%d' % len(a)",
    "x = 'a b\\nc'.splitlines()[0].replace(' ', '_')",
    'x = ("%r" % "r").strip("\x27")',
]


@pytest.mark.parametrize("text", LISTS)
def test_as_python_does(text):
    scope = {}
    exec(text, scope)
    assert names(python(f"{text}\nP(x)\n")) == [scope["x"]]


@pytest.mark.parametrize(
    "text",
    [
        "x = u'\\xe9nc'.encode('ascii', 'ignore').decode()",
        "a = ['q', 'r']; a[::2] = ['s', 't']; x = 'n%d' % len(a)",
        "a = ['q', 'r']; a[unknown():] = []; x = 'n%d' % len(a)",
    ],
)
def test_what_is_not_known_is_not_guessed(text):
    (declared,) = python(f"{text}\nP(x)\n").declarations
    assert declared.resolution == "symbolic"


PRIVATE_CLASS = """
class Api:
    instance = None

    def __init__(self):
        if not Api.instance:
            Api.instance = Api.__Api()

    class __Api:
        def __init__(self):
            P('x')


Api()
"""


def test_a_class_that_is_private_to_another():
    interface = python(PRIVATE_CLASS)
    assert (names(interface), interface.unresolved) == (["x"], ())


def test_what_two_sets_share_is_open_where_an_item_is_not_known():
    interface = python("for name in {'a', unknown()} & {'a', 'b'}:\n    P(name)")
    assert "a" in names(interface)


@pytest.mark.parametrize("target", ["name, kinds", "i, (name, kinds)", "[name, _]", "name, *rest"])
def test_an_unknown_item_of_several_variables_is_named_by_each(target):
    assert names(python(f"for {target} in unknown():\n    P(name)\n")) == ["{name}"]
