"""What a function keeps, tests and returns, as far as it tells what becomes of a message."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from rtron.sources.code import ir
from rtron.sources.code.ir.references import cache_by_identity, ir_nodes
from rtron.vocabulary.names import snake_case

_COMPARISONS = frozenset({"<", ">", "<=", ">="})
RESULT = "result"
"""What `a if late else b` is given to."""
_LOGGING = re.compile(
    r"(?:log)?_?(?:debug|info|warn|warning|error|fatal|critical)(?:_\w+)?|print|log"
)
SELF = frozenset({"self", "this"})
_STOP_NAME = re.compile(
    r"(?:(?:all|apply|base|car|cmd|command|controller|do|drive|emergency|force|full|go|hard"
    r"|motors?|publish|robot|safe|safety|send|set|soft|speed|timeout|to|vehicle|vel|velocity"
    r"|watchdog|wheels?|write)_)*"
    r"(?:e_?stop|stop|zeros?|halt|brake|neutral|idle|coast|disable|shut_?down)"
    r"(?:_(?:all|base|both|car|chassis|cmd|commands?|drive|driving|engine|front|it|left|motion"
    r"|motors?|movement|moving|now|outputs?|pwm|rear|right|robot|rover|servos?|speeds?|thrusters?"
    r"|torque|twist|vehicle|vel|velocity|velocities|wheels?))*"
)
"""Names of functions that stop what drives: a verb, and nothing but that beside it."""
_SHOWING = frozenset(
    [
        *("led", "leds", "light", "lights", "lamp", "buzzer", "beep", "horn", "sound", "status"),
        *("state", "display", "lcd", "oled", "screen", "diagnostics", "indicator", "online"),
    ]
)
"""Words in the names of what shows or sounds, and moves nothing."""
ADDING = frozenset(
    [
        *("append", "appendleft", "extend", "insert", "push", "push_back", "emplace_back"),
        *("put", "put_nowait", "__setitem__"),
    ]
)
"""Methods that put something into a container."""


@dataclass(frozen=True, slots=True)
class Test:
    """A condition of a function, with what runs where it holds and where it does not."""

    condition: ir.Expr
    branches: tuple[Any, ...]
    line: int


class FunctionSteps:
    """What a function does, as far as it matters here; `members` outlive its call.

    `marks` are the constants that it writes to members, or into them, `clocks` the names of the
    program's own functions that tell the time, `done` what is called for its effect alone.
    """

    def __init__(
        self, function: ir.Function, *, is_cpp: bool, clocks: frozenset[str] = frozenset()
    ) -> None:
        self.function = function
        self.clocks = clocks
        nodes = list(ir_nodes(function.body))
        self.declared = {n.name for n in nodes if isinstance(n, ir.Declare)}
        self.declared |= {param.name for param in function.params}
        self.globals = {name for n in nodes if isinstance(n, ir.Global) for name in n.names}
        self.is_cpp = is_cpp
        self.tests = [test for node in nodes if (test := _test(node))]
        self.returned = [n.value for n in nodes if isinstance(n, ir.Return) and n.value is not None]
        self.calls = [n for n in nodes if isinstance(n, ir.Call)]
        self.done = [
            n.value for n in nodes if isinstance(n, ir.Evaluate) and isinstance(n.value, ir.Call)
        ]
        loops = [part for n in nodes if isinstance(n, ir.While) for part in ir_nodes(n.body)]
        self.loop_calls = {last_name(n.function) for n in loops if isinstance(n, ir.Call)}
        self.members: list[tuple[str, ir.Expr]] = []
        self.locals: list[tuple[str, ir.Expr]] = []
        self.marks: set[tuple[str, ir.Expr]] = set()
        for node in nodes:
            for target, value in (*assignments(node), *_additions(node)):
                stored = self.member(target)
                (self.members if stored else self.locals).append(
                    (stored or last_name(target), value)
                )
                if stored and is_constant(value):
                    self.marks.add((last_name(target), value))

    @property
    def is_constructor(self) -> bool:
        """Whether it runs once, before all others."""
        owner, _, name = self.function.name.rpartition("::")
        return not self.loop_calls and (name == "__init__" or owner.rpartition("::")[2] == name)

    def member(self, target: ir.Expr) -> str:
        """Return the member or global below which something is written, empty for a local."""
        own = {"this"} if self.is_cpp else {p.name for p in self.function.params[:1]}
        while isinstance(target, (ir.Attr, ir.Index)):
            owner = target.owner
            if isinstance(target, ir.Attr) and isinstance(owner, ir.Name) and owner.id in own:
                return target.name
            target = owner
        plain = last_name(target)
        is_member = plain not in self.declared if self.is_cpp else plain in self.globals
        return plain if is_member else ""


def _test(node: object) -> Test | None:
    if isinstance(node, ir.If):
        return Test(node.test, (node.body, node.orelse), node.line)
    if isinstance(node, ir.While):
        return Test(node.test, (node.body,), node.line)
    if isinstance(node, ir.Conditional):
        return Test(node.test, (_as_result(node.body), _as_result(node.orelse)), 0)
    return None


def _as_result(value: ir.Expr) -> ir.Assign:
    return ir.Assign((ir.Name(RESULT),), value)


def assignments(node: object) -> Iterator[tuple[ir.Expr, ir.Expr]]:
    """Yield what a step writes to, and the values."""
    if isinstance(node, ir.Assign):
        yield from ((target, node.value) for target in node.targets)
    elif isinstance(node, ir.Declare) and node.value is not None:
        yield ir.Name(node.name), node.value


def _additions(node: object) -> Iterator[tuple[ir.Expr, ir.Expr]]:
    """Yield the containers that a step puts something into, and the values."""
    if (
        isinstance(node, ir.Call)
        and isinstance(node.function, ir.Attr)
        and node.function.name in ADDING
    ):
        yield from ((node.function.owner, value) for value in node.args)


def last_name(part: ir.Expr) -> str:
    """Return the last name of what is called or written to."""
    while isinstance(part, ir.Index):
        part = part.owner
    if isinstance(part, ir.Attr):
        return part.name
    return part.id.rpartition("::")[2] if isinstance(part, ir.Name) else ""


@cache_by_identity
def mentioned_names(part: Any) -> frozenset[str]:  # noqa: ANN401 - any part of the IR
    """Return the last names of all variables, members and functions in a part."""
    return frozenset(last_name(n) for n in ir_nodes(part) if isinstance(n, (ir.Attr, ir.Name)))


def is_constant(value: ir.Expr) -> bool:
    """Return whether a value is written out."""
    return isinstance(value, ir.Const)


def is_comparison(node: object) -> bool:
    """Return whether a part asks which of two is larger."""
    return isinstance(node, ir.Binary) and node.operator in _COMPARISONS


def is_zero(value: object) -> bool:
    """Return whether a value is zero: a number, numbers, or a message with nothing set."""
    if isinstance(value, ir.Const):
        return not isinstance(value.value, (bool, str, bytes)) and value.value == 0
    if isinstance(value, ir.SequenceExpr):
        return all(map(is_zero, value.items))
    if isinstance(value, ir.Binary) and value.operator == "*":
        return isinstance(value.left, ir.SequenceExpr) and is_zero(value.left)
    if isinstance(value, ir.New):
        return not value.args or all(map(is_zero, value.args))
    if not isinstance(value, ir.Call) or not last_name(value.function)[:1].isupper():
        return False
    return all(map(is_zero, given(value)))


def is_stop(node: object, sent: frozenset[str], outputs: frozenset[str]) -> bool:
    """Return whether a step sets what is sent to zero, outputs a zero, or is called like a stop."""
    if _SHOWING.intersection(word for name in mentioned_names(node) for word in _words(name)):
        return False
    if isinstance(node, ir.Evaluate) and isinstance(node.value, ir.Call):
        is_output = last_name(node.value.function) in outputs
        return is_called_stop(node.value) or (is_output and any(map(is_zero, given(node.value))))
    return any(is_zero(v) and mentioned_names(t) & sent for t, v in assignments(node))


def is_called_stop(call: ir.Call) -> bool:
    """Return whether the name of what is called says that it stops what drives."""
    return bool(_STOP_NAME.fullmatch("_".join(_words(last_name(call.function)))))


def given(call: ir.Call) -> tuple[ir.Expr, ...]:
    """Return what a call is given, by position and by name."""
    return (*call.args, *(value for _, value in call.keywords))


def _words(name: str) -> list[str]:
    return snake_case(name).strip("_").split("_")


def is_log(call: ir.Call) -> bool:
    """Return whether a call only tells people something."""
    return bool(_LOGGING.fullmatch(last_name(call.function)))


def is_logger(call: ir.Call) -> bool:
    """Return whether a call returns what logs."""
    return snake_case(last_name(call.function)) == "get_logger"
