"""What Python calls by other names, and what it never calls: run or noted with its place."""

import pytest
from ros1_runs import names, python, run_text

RUN_LATER = {
    "an alias of an import": "from rospy import Publisher as A\ndef cb(e): A('x', Bool)",
    "an alias of a function": "A = P\ndef cb(e): A('x')",
    "a table": "T = {'a': P}\ndef cb(e): T['a']('x')",
    "a list that is added to": "L = []\nL.append(P)\ndef cb(e): [f('x') for f in L]",
    "a member": "class C: pass\nc = C()\nc.make = P\ndef cb(e): c.make('x')",
    "an argument by name": "def f(make): return lambda: make('x')\ng = f(make=P)\ndef cb(e): g()",
    "a base class": "class C(rospy.Publisher): pass\ndef cb(e): C('x', Bool)",
    "a decorator": "def d(f): return lambda: P(f())\n@d\ndef n(): return 'x'\ndef cb(e): n()",
    "a property": "class C:\n @property\n def end(self): P('x')\nc = C()\ndef cb(e): c.end",
    "an operation": "class C:\n def __getitem__(self, k): P(k)\nc = C()\ndef cb(e): c['x']",
    "an argument": "def run(f): f('x')\ndef cb(e, f=P): run(f)",
    "getattr": "def cb(e): getattr(rospy, 'Pub' + 'lisher')('x', Bool)",
    "two lambdas in a line": "a, cb = lambda: 1, lambda e: P('x')",
}


@pytest.mark.parametrize("body", RUN_LATER.values(), ids=RUN_LATER)
def test_a_callback_runs_whatever_it_calls_by(body):
    interface = python(f"{body}\nrospy.Timer(1, cb)")
    assert names(interface) == ["x"]
    assert [note for note in interface.unresolved if note.what != "P()"] == []


UNREACHED = {
    "direct": "def never(): rospy.Service('x', Bool, P)\n",
    "by a wrapper": "P('y')\ndef never(): P('x')\n",
    "by an alias": "A = P\nA('y')\ndef never(): A('x')\n",
}


@pytest.mark.parametrize("body", UNREACHED.values(), ids=UNREACHED)
def test_what_nothing_calls_is_noted_with_its_line(body):
    text = "import rospy\nfrom std_msgs.msg import Bool\ndef P(n): rospy.Publisher(n, Bool)\n"
    (note,) = run_text(text + body).unresolved
    line = (text + body).splitlines().index(next(x for x in body.splitlines() if "never" in x))
    assert line + 1 in [place.line for place in note.evidence]


def test_each_function_that_nothing_calls_has_its_place():
    (note,) = python("def a(): P('x')\ndef b(): P('y')\nP('z')\n").unresolved
    assert (note.what, len(note.evidence)) == ("a() and 1 more", 2)


def test_another_program_s_main_is_not_noted():
    assert python("class C:\n def __init__(self): P('x')\ndef main(): C()\nC()").unresolved == ()


def test_a_function_that_calls_its_argument_is_noted_where_it_is_cut():
    loop = "def loop(f):\n    for i in range(100):\n        for j in range(30):\n"
    body = "            for k in range(8): f(i, j, k)\n"
    interface = python(f"{loop}{body}loop(print)\nP('y')")
    assert names(interface) == ["y"]
    assert [note.why for note in interface.unresolved] == ["too large to be run whole"]


@pytest.mark.parametrize("maker", ["mqtt.Client('a')", "mqtt.Client('a').session", "unknown"])
def test_a_function_assigned_to_a_member_of_a_foreign_object_is_a_callback(maker):
    body = "import mqtt\ndef hear(client, message): P('x')\nunknown = mqtt.make()\n"
    interface = python(f"{body}client = {maker}\nclient.on_message = hear\nclient.loop_forever()")
    assert (names(interface), interface.unresolved) == (["x"], ())


def test_a_function_assigned_to_a_member_of_an_own_object_waits_for_its_call():
    body = "class C: pass\ndef hear(message): P('x')\nclient = C()\nclient.on_message = hear\n"
    assert names(python(f"{body}P('y')")) == ["y"]
    assert names(python(f"{body}client.on_message(1)")) == ["x"]
