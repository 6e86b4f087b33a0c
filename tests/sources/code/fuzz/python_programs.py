"""Programs for rospy and rclpy whose endpoints are known by construction, made from a seed.

They are put together from the templates in `python_templates/`, in which `@` makes a program's
variables its own:

- `names_*`: ways to a name. The last line is the expression. NAME is the name as a literal, HEAD
  and TAIL its two halves, UPPER its upper case, NUMBER and WORD what it is made of (`t012_word`).
- `calls*`: ways to an endpoint of a name. E is the expression of the name, F a function that makes
  the endpoint of a name, DIRECT(x) and KEYWORDS(x) make it of the name x; MAKER is the library's
  own function or class, ARGS(x) its arguments.
- `places_*`: places that surely run (live), run once the node spins (later), or never do (dead);
  BLOCK is there.
"""

import random
import re
from dataclasses import dataclass, field
from functools import cache
from itertools import count
from pathlib import Path
from textwrap import indent

_HEAD = """import abc, argparse, ast, asyncio, collections, concurrent.futures, contextlib, copy
import dataclasses, enum, functools, importlib, itertools, json, operator, os, pathlib, queue
import string, sys, threading, types, typing
import yaml
"""
_TEMPLATES = Path(__file__).parent / "python_templates"
_NAME_KINDS = ("plain", "containers", "functions", "classes")
_WORDS = ("alpha", "beta", "gamma", "delta")
_PLACEHOLDER = re.compile(r"\b(NAME|HEAD|TAIL|UPPER|NUMBER|WORD)\b")
_DEAD_SHARE = 0.25


@dataclass(frozen=True)
class Library:
    """A client library: how a program begins and ends, and what makes each kind of endpoint.

    A maker is (the function or class, its arguments around the name `%s`, the same by keyword, a
    partial of it, whether it is a class).
    """

    name: str
    ros: int
    head: str
    tail: str
    makers: dict[str, tuple[str, str, str, str, bool]]


@dataclass(frozen=True)
class Endpoint:
    """What one fragment declares: its lines (first, last), and whether these ever run."""

    kind: str
    name: str
    lines: tuple[int, int]
    lives: bool


@dataclass(frozen=True)
class Program:
    """A program's text and its endpoints."""

    text: str
    endpoints: tuple[Endpoint, ...] = field(default=())


ROSPY = Library(
    name="rospy",
    ros=1,
    head=f"""{_HEAD}import rospy, actionlib
from actionlib.msg import TestAction
from std_msgs.msg import String
from tf2_msgs.srv import FrameGraph

keep = [None]


SERVER = {{"ActionSpec": TestAction, "auto_start": True}}


def serve(request):
    return None


rospy.init_node("n")
""",
    tail='print("READY", flush=True)\nrospy.spin()\n',
    makers={
        "publish": (
            "rospy.Publisher",
            "%s, String, queue_size=1",
            "name=%s, data_class=String, queue_size=1",
            "functools.partial(rospy.Publisher, data_class=String, queue_size=1)",
            True,
        ),
        "subscribe": (
            "rospy.Subscriber",
            "%s, String, serve",
            "name=%s, data_class=String",
            "functools.partial(rospy.Subscriber, data_class=String, callback=serve)",
            True,
        ),
        "service": (
            "rospy.Service",
            "%s, FrameGraph, serve",
            "name=%s, service_class=FrameGraph, handler=serve",
            "functools.partial(rospy.Service, service_class=FrameGraph, handler=serve)",
            True,
        ),
        "service_client": (
            "rospy.ServiceProxy",
            "%s, FrameGraph",
            "name=%s, service_class=FrameGraph",
            "functools.partial(rospy.ServiceProxy, service_class=FrameGraph)",
            True,
        ),
        "action_client": (
            "actionlib.SimpleActionClient",
            "%s, TestAction",
            "ns=%s, ActionSpec=TestAction",
            "functools.partial(actionlib.SimpleActionClient, ActionSpec=TestAction)",
            True,
        ),
        "action_server": (
            "actionlib.SimpleActionServer",
            "%s, TestAction, execute_cb=serve, auto_start=True",
            "name=%s, ActionSpec=TestAction, execute_cb=serve, auto_start=True",
            "functools.partial(actionlib.SimpleActionServer, **SERVER)",
            True,
        ),
    },
)
RCLPY = Library(
    name="rclpy",
    ros=2,
    head=f"""{_HEAD}import rclpy
from rcl_interfaces.srv import GetParameters
from rclpy.action import ActionClient, ActionServer
from rclpy.node import Node
from std_msgs.msg import String
from test_msgs.action import Fibonacci

keep = [None]


def serve(request, response=None):
    return response


rclpy.init()
node = rclpy.create_node("n")
""",
    tail='print("READY", flush=True)\nrclpy.spin(node)\n',
    makers={
        "publish": (
            "node.create_publisher",
            "String, %s, 10",
            "msg_type=String, topic=%s, qos_profile=10",
            "functools.partial(node.create_publisher, String, qos_profile=10)",
            False,
        ),
        "subscribe": (
            "node.create_subscription",
            "String, %s, serve, 10",
            "msg_type=String, topic=%s, callback=serve, qos_profile=10",
            "functools.partial(node.create_subscription, String, callback=serve, qos_profile=10)",
            False,
        ),
        "service": (
            "node.create_service",
            "GetParameters, %s, serve",
            "srv_type=GetParameters, srv_name=%s, callback=serve",
            "functools.partial(node.create_service, GetParameters, callback=serve)",
            False,
        ),
        "service_client": (
            "node.create_client",
            "GetParameters, %s",
            "srv_type=GetParameters, srv_name=%s",
            "functools.partial(node.create_client, GetParameters)",
            False,
        ),
        "action_client": (
            "ActionClient",
            "node, Fibonacci, %s",
            "node=node, action_type=Fibonacci, action_name=%s",
            "functools.partial(ActionClient, node, Fibonacci)",
            True,
        ),
        "action_server": (
            "ActionServer",
            "node, Fibonacci, %s, serve",
            "node=node, action_type=Fibonacci, action_name=%s, execute_callback=serve",
            "functools.partial(ActionServer, node, Fibonacci, execute_callback=serve)",
            True,
        ),
    },
)


@cache
def templates(*names):
    """Return the templates of some files, which a line of dashes parts."""
    texts = [(_TEMPLATES / f"{name}.txt").read_text() for name in names]
    return [part.strip("\n") for text in texts for part in text.split("---\n")]


class Maker:
    """Makes the program of one seed."""

    def __init__(self, library, seed):
        self._library = library
        self._random = random.Random(seed)
        self._numbers = count(1)

    def program(self, fragments):
        """Return a program of so many fragments."""
        return self._joined(self._fragment(number) for number in range(1, fragments + 1))

    def single(self, form, named, place, *, lives):
        """Return a program of one fragment, which publishes."""
        block = self._own(_within(place, self._block("publish", 1, _WORDS[0], form, named)))
        return self._joined([(block, ("publish", f"t001_{_WORDS[0]}", lives))])

    def _joined(self, fragments):
        lines, found = self._library.head.splitlines(), []
        for text, (kind, name, lives) in fragments:
            first = len(lines) + 1
            lines += text.splitlines()
            found.append(Endpoint(kind, name, (first, len(lines)), lives))
        lines += self._library.tail.splitlines()
        return Program("\n".join(lines) + "\n", tuple(found))

    def _fragment(self, number):
        kind = self._choose(list(self._library.makers))
        word = self._choose(_WORDS)
        form = self._choose(_forms(self._library, kind))
        named = self._choose(_name_templates(self._library))
        block = self._block(kind, number, word, form, named)
        lives, depth = self._random.random() > _DEAD_SHARE, self._choose([0, 0, 1, 1, 2])
        places = [self._place("places_live") for _ in range(depth)]
        if not lives:
            places.insert(self._random.randrange(depth + 1), self._place("places_dead"))
        elif self._random.random() < 0.15:
            places.append(self._place(f"places_later_{self._library.name}"))
        for place in places:
            block = _within(self._own(place), block)
        return block, (kind, f"t{number:03d}_{word}", lives)

    def _block(self, kind, number, word, form, named):
        """Return statements that make an endpoint of a name."""
        maker = self._library.makers[kind]
        setup, _, expression = self._own(_named(named, number, word)).rpartition("\n")
        statements = self._own(_called(form, maker, f"({expression})", self._choose))
        return f"{setup}\n{statements}".strip("\n")

    def _place(self, file):
        return self._choose(templates(file))

    def _own(self, text):
        return re.sub(r"(?<=\w)@", f"_{next(self._numbers)}", text)

    def _choose(self, found):
        return self._random.choice(found)


def _forms(library, kind):
    """Return the forms of calls that make a kind of endpoint; the rarer ones count twice."""
    subclasses = templates("calls_subclasses") * 2 if library.makers[kind][4] else []
    own = templates(f"calls_{library.name}") if kind == "publish" else []
    return [*templates("calls"), *subclasses, *own]


def _name_templates(library):
    return templates(*(f"names_{kind}" for kind in (*_NAME_KINDS, library.name)))


def _named(template, number, word):
    head, tail = f"t{number:03d}_", word
    parts = {
        "NAME": repr(head + tail),
        "HEAD": repr(head),
        "TAIL": repr(tail),
        "UPPER": repr((head + tail).upper()),
        "NUMBER": str(number),
        "WORD": repr(word),
    }
    return _PLACEHOLDER.sub(lambda found: parts[found[0]], template)


def _called(form, maker, expression, choose):
    """Fill a form in: DIRECT(x), KEYWORDS(x) and ARGS(x) have no parentheses in x."""
    function, args, keywords, partial, _ = maker
    called = choose([f"(lambda n: {function}({args % 'n'}))", partial])
    text = re.sub(r"\bDIRECT\(([^()]*)\)", lambda m: f"{function}({args % m[1]})", form)
    text = re.sub(r"\bKEYWORDS\(([^()]*)\)", lambda m: f"{function}({keywords % m[1]})", text)
    text = re.sub(r"\bARGS\(([^()]*)\)", lambda m: args % m[1], text)
    text = re.sub(r"\bMAKER\b", lambda _: function, text)
    text = re.sub(r"\bF\b", lambda _: called, text)
    return re.sub(r"\bE\b", lambda _: expression, text)


def _within(place, block):
    """Put a block where a place has it."""
    lines = []
    for line in place.splitlines():
        if line.strip() == "BLOCK":
            lines.append(indent(block, line[: len(line) - len(line.lstrip())]))
        else:
            lines.append(line)
    return "\n".join(lines)


def make_program(library, seed):
    """Return the program of a seed."""
    return Maker(library, seed).program(6)


def single_programs(library):
    """Yield a program for each way to a name, each form of a call and each place, alone."""
    plain, inline = "DIRECT(E)", "BLOCK"
    for named in _name_templates(library):
        yield Maker(library, 0).single(plain, named, inline, lives=True)
    for form in dict.fromkeys(_forms(library, "publish")):
        yield Maker(library, 0).single(form, "NAME", inline, lives=True)
    for place in templates("places_live", f"places_later_{library.name}"):
        yield Maker(library, 0).single(plain, "NAME", place, lives=True)
    for place in templates("places_dead"):
        yield Maker(library, 0).single(plain, "NAME", place, lives=False)
