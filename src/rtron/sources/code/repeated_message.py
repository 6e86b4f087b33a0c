"""Where what a callback keeps is published again and again, and whether it is ever cleared."""

from collections.abc import Iterator
from itertools import chain, repeat
from typing import Any, NamedTuple

from rtron.sources.code import ir
from rtron.sources.code.function_steps import (
    ADDING,
    SELF,
    FunctionSteps,
    Test,
    assignments,
    given,
    is_constant,
    is_log,
    is_zero,
    last_name,
    mentioned_names,
)
from rtron.sources.code.ir.references import called_names, ir_nodes

_TAKING = frozenset(
    [
        *("reset", "clear", "pop", "popleft", "pop_front", "pop_back", "erase", "remove"),
        *("release", "move", "exchange", "swap"),
    ]
)
_EQUAL, _OTHER = frozenset({"==", "is"}), frozenset({"!=", "is not"})


class Repetition(NamedTuple):
    """How what runs beside a callback publishes what that stored."""

    publishers: frozenset[str]
    """The names of the publishers it goes to; nothing is repeated if there are none."""
    is_cleared: bool
    """Whether who publishes, or else uses it, also assigns it anew or takes it away."""


def find_repetition(
    stored: set[str], reached: list[FunctionSteps], beside: list[FunctionSteps]
) -> Repetition:
    """Return how functions beside a callback publish what it stored, which reaches `reached`.

    One function keeps and publishes it, or one of the two calls the other. A callback that
    publishes itself does not count.
    """
    if any(_publish_calls(each) for each in reached):
        return Repetition(frozenset(), is_cleared=False)
    users = [each for each in beside if stored & mentioned_names(each.function.body)]
    senders = [each for each in beside if _publish_calls(each)]
    found = [(u, s, names) for u in users for s in senders if (names := _publishers(stored, u, s))]
    pairs = [pair for *pair, _ in found]
    called = [f for f in beside if any(_calls(each, f) for pair in pairs for each in pair)]
    takers = chain(*pairs, called) if found else (u for u in users if _reads(u, stored))
    return Repetition(
        frozenset().union(*(names for *_, names in found)),
        is_cleared=any(is_cleared_by(each, stored) for each in takers),
    )


def _reads(code: FunctionSteps, stored: set[str]) -> bool:
    """Return whether a function uses what was stored, and does not only set it."""
    given = [value for node in ir_nodes(code.function.body) for _, value in assignments(node)]
    passed = [part for call in code.calls for part in (call.args, call.keywords)]
    return any(mentioned_names(part) & stored for part in (*given, *passed))


def is_counted(reached: list[FunctionSteps], others: list[FunctionSteps]) -> bool:
    """Return whether somebody tests a number that counts messages, or the time without them."""
    pairs = [pair for each in reached for pair in each.members]
    written = {name for name, _ in pairs} | {last_name(value) for _, value in pairs}
    counters = {
        name
        for each in (*reached, *others)
        for name, value in each.members
        if name in written and _is_step(name, value)
    }
    conditions = [n for each in others for n in _conditions(each)] if counters else []
    return any(mentioned_names(each) & counters for each in conditions)


def _conditions(code: FunctionSteps) -> Iterator[ir.Expr]:
    yield from (test.condition for test in code.tests)
    for node in ir_nodes(code.function.body):
        if isinstance(node, ir.Binary) and node.operator in {"<", ">", "<=", ">=", "==", "!="}:
            yield node


def _is_step(name: str, value: ir.Expr) -> bool:
    """Return whether a value is what a name held, and a number more or less; at least zero, too."""
    return any(
        isinstance(node, ir.Binary)
        and node.operator.rstrip("=") in {"+", "-"}
        and any(is_constant(side) for side in (node.left, node.right))
        and name in {last_name(node.left), last_name(node.right)}
        for node in ir_nodes(value)
    )


def is_compared(stored: set[str], others: list[FunctionSteps]) -> bool:
    """Return whether somebody keeps what was stored, and acts where the next is still the same."""
    members = [pair for each in others for pair in each.members]
    copies = {name for name, value in members if mentioned_names(value) & stored} - stored
    return any(_acts_on_same(test, stored, copies) for each in others for test in each.tests)


def _acts_on_same(test: Test, stored: set[str], copies: set[str]) -> bool:
    for node in ir_nodes(test.condition):
        if isinstance(node, ir.Binary) and node.operator in _EQUAL | _OTHER:
            sides = mentioned_names(node.left), mentioned_names(node.right)
            is_pair = any(one & stored and other & copies for one, other in (sides, sides[::-1]))
            branch = test.branches[node.operator in _OTHER :][:1] if is_pair else ()
            if any(_acts(each) for each in ir_nodes(branch)):
                return True
    return False


def _acts(node: object) -> bool:
    return isinstance(node, ir.Assign) or (isinstance(node, ir.Call) and not is_log(node))


def _publishers(stored: set[str], user: FunctionSteps, sender: FunctionSteps) -> set[str]:
    """Return the publishers in a function that get what another, or itself, makes of a value."""
    if user is sender:
        return _fed_publishers(user, stored)
    made = made_of(user, stored)
    names = stored | (made & {name for name, _ in user.members})
    if _calls(sender, user):
        return _fed_publishers(sender, names | {_name(user)})
    if not _calls(user, sender):
        return set()
    calls = [call for call in user.calls if last_name(call.function) == _name(sender)]
    chosen = dependent_nodes(user, made)
    if any(call is node for call in calls for node in chosen):
        return {_publisher(call) for call in _publish_calls(sender)}
    params = {param.name for param in sender.function.params[not sender.is_cpp :]}
    is_given = any(mentioned_names((call.args, call.keywords)) & made for call in calls)
    return _fed_publishers(sender, names | params if is_given else names)


def _fed_publishers(code: FunctionSteps, names: set[str]) -> set[str]:
    """Return the names of the publishers in a function that get what it makes of names."""
    made = made_of(code, names)
    chosen = {id(node) for node in dependent_nodes(code, made)}
    return {
        _publisher(call)
        for call in _publish_calls(code)
        if id(call) in chosen or mentioned_names((call.args, call.keywords)) & made
    }


def made_of(code: FunctionSteps, names: set[str]) -> set[str]:
    """Return names, and those of what a function makes of them."""
    made, before = set(names), 0
    while len(made) > before:
        before = len(made)
        for node in ir_nodes(code.function.body):
            made |= _fed_names(code, node, made)
        chosen = dependent_nodes(code, made)
        made |= {root for n in chosen for t, _ in assignments(n) for root in _roots(t, code)}
    return made


def _fed_names(code: FunctionSteps, node: object, made: set[str]) -> set[str]:
    if isinstance(node, ir.Call) and isinstance(node.function, ir.Attr):
        is_adding = node.function.name in ADDING and mentioned_names(node.args) & made
        return _roots(node.function.owner, code) if is_adding else set()
    fed = (target for target, value in assignments(node) if mentioned_names(value) & made)
    return {root for target in fed for root in _roots(target, code)}


def dependent_nodes(code: FunctionSteps, names: set[str]) -> list[Any]:
    """Return what a function does only where a test of names says so."""
    tests = (test for test in code.tests if mentioned_names(test.condition) & names)
    return [node for test in tests for node in ir_nodes(test.branches)]


def find_outputs(codes: list[FunctionSteps], stored: set[str]) -> frozenset[str]:
    """Return the names of what is called for its effect with what functions make of stored values.

    What a function is given may be made of them, too. Who passes it on is an output as well.
    """
    outputs = {"publish"}
    names = _kept_values(codes, stored)
    for code in codes:
        params = {param.name for param in code.function.params} - SELF
        made = made_of(code, names | params)
        fed = {last_name(c.function) for c in code.done if mentioned_names(given(c)) & made}
        outputs |= fed | ({_name(code)} if fed else set())
    return frozenset(outputs)


def _kept_values(codes: list[FunctionSteps], stored: set[str]) -> set[str]:
    """Return names of values that were stored, and of the members that functions make of them."""
    names, before = set(stored), -1
    while len(names) > before:
        before = len(names)
        for code in codes:
            if mentioned_names(code.function.body) & names:
                names |= made_of(code, names) & {name for name, _ in code.members}
    return names


def is_cleared_by(code: FunctionSteps, stored: set[str]) -> bool:
    """Return whether a function assigns what was stored anew, or takes it away."""
    made = made_of(code, stored)
    for node in ir_nodes(code.function.body):
        if isinstance(node, ir.Call) and last_name(node.function) in _TAKING:
            if mentioned_names(node) & stored:
                return True
        elif any(_is_anew(t, value, code, stored, made) for t, value in assignments(node)):
            return True
    return False


def _is_anew(
    target: ir.Expr, value: ir.Expr, code: FunctionSteps, stored: set[str], made: set[str]
) -> bool:
    """Return whether something is stored that is not `made` of what was."""
    if isinstance(target, ir.SequenceExpr):
        given = value.items if isinstance(value, ir.SequenceExpr) else ()
        is_each = len(given) == len(target.items)
        pairs = zip(target.items, given if is_each else repeat(value), strict=False)
        return any(_is_anew(*pair, code, stored, made) for pair in pairs)
    if code.member(target) not in stored:
        return False
    is_number = isinstance(value, ir.Const) and not isinstance(value.value, (str, bytes))
    is_whole = last_name(target) in stored
    is_other = is_whole and not mentioned_names(value) & made
    return is_number or is_zero(value) or is_other or (is_whole and isinstance(value, ir.Binary))


def _roots(target: ir.Expr, code: FunctionSteps) -> set[str]:
    """Return the variables, or own members, in or below which something is written."""
    if isinstance(target, ir.SequenceExpr):
        return {root for item in target.items for root in _roots(item, code)}
    inner: ir.Expr = target
    while isinstance(inner, (ir.Attr, ir.Index)):
        inner = inner.owner
    return {code.member(target) or last_name(inner)} - {""}


def _publish_calls(code: FunctionSteps) -> list[ir.Call]:
    return [call for call in code.calls if last_name(call.function) == "publish"]


def _publisher(call: ir.Call) -> str:
    return last_name(call.function.owner) if isinstance(call.function, ir.Attr) else ""


def _calls(caller: FunctionSteps, called: FunctionSteps) -> bool:
    return _name(called) in called_names(caller.function)


def _name(code: FunctionSteps) -> str:
    return code.function.name.rpartition("::")[2]
