"""Signs that a program notices when no more messages come: watchdogs, and waits with a limit."""

import re

from rtron.sources.code.function_steps import (
    SELF,
    FunctionSteps,
    assignments,
    last_name,
    mentioned_names,
)
from rtron.sources.code.ir import Attr, Call, Expr, Index, Name, SequenceExpr
from rtron.sources.code.ir.references import ir_nodes

CLOCKS = frozenset(
    [
        *("now", "time", "time_ns", "monotonic", "monotonic_ns", "perf_counter", "get_time"),
        *("get_rostime", "utcnow", "millis", "micros", "clock_gettime", "gettimeofday", "stamp"),
    ]
)
"""Names of functions and members that tell the time."""
_TIMERS = re.compile(r"timer|watch_?dog", re.IGNORECASE)
_RESTARTS = frozenset({"reset", "start", "restart", "cancel", "stop", "feed", "kick", "setPeriod"})
_TIMER_MAKERS = frozenset({"Timer", "createTimer", "create_timer", "create_wall_timer"})
_ALARMS = frozenset(
    {"call_later", "call_at", "expires_after", "expires_from_now", "setitimer", "alarm"}
)
"""What a callback starts anew, and what comes where no more does."""
_TIMED_WAITS = frozenset({"wait_for", "wait_until", "get_nowait"})
_DEADLINES = frozenset({"deadline_callback", "SubscriptionEventCallbacks"})
_KEEPING = frozenset({"update", "append", "put", "set", "store"})


def may_be_watched(reached: list[FunctionSteps], others: list[FunctionSteps]) -> bool:
    """Return whether a callback restarts a timer or keeps the time, or silence has a callback."""
    has_deadline = any(not _DEADLINES.isdisjoint(mentioned_names(o.function.body)) for o in others)
    return has_deadline or _restarts_timer(reached) or any(map(_keeps_time, reached))


def has_timed_wait(reached: list[FunctionSteps], others: list[FunctionSteps]) -> bool:
    """Return whether somebody waits for the message for so long."""
    shared = set[str]().union(*(mentioned_names(each.function.body) for each in reached)) - SELF
    return any(
        (last_name(call.function) in _TIMED_WAITS or _is_wait(call))
        and mentioned_names(call) - {last_name(call.function)} & shared
        for each in others
        for call in each.calls
    )


def _is_wait(call: Call) -> bool:
    name = last_name(call.function)
    is_timed = any(key == "timeout" for key, _ in call.keywords)
    return (name in {"get", "wait"} and is_timed) or (name == "wait" and bool(call.args))


def _keeps_time(code: FunctionSteps) -> bool:
    """Return whether a function puts the time where no test of a member would find it.

    In an item, something else's member, a global or beside other values, but in no header.
    """
    for node in ir_nodes(code.function.body):
        for target, value in assignments(node):
            if is_time(value, code) and _is_hidden(target, value, code):
                return True
        is_keeping = isinstance(node, Call) and last_name(node.function) in _KEEPING
        given = (*node.args, *(v for _, v in node.keywords)) if is_keeping else ()
        if any(is_time(each, code) for each in given):
            return True
    return False


def _is_hidden(target: Expr, value: Expr, code: FunctionSteps) -> bool:
    if "stamp" in mentioned_names(target):
        return False
    is_item = isinstance(target, Index) and last_name(target) not in code.declared
    is_others = isinstance(target, Attr) and not isinstance(target.owner, Name)
    is_beside = isinstance(value, SequenceExpr) and bool(code.member(target))
    return is_item or is_others or is_beside or last_name(target) in code.globals


def is_time(value: Expr, code: FunctionSteps) -> bool:
    """Return whether a value is now, or a message's stamp; a local may hold it."""
    names = mentioned_names(value)
    return bool(names & CLOCKS) or any(
        name in names and mentioned_names(given) & CLOCKS for name, given in code.locals
    )


def _restarts_timer(reached: list[FunctionSteps]) -> bool:
    """Return whether a callback starts a timer anew, which stops where nothing comes."""
    return any(_starts_timer(call.function) for each in reached for call in each.calls)


def _starts_timer(function: Expr) -> bool:
    if isinstance(function, Attr) and function.name in _RESTARTS:
        return any(_TIMERS.search(name) for name in mentioned_names(function.owner))
    return last_name(function) in _TIMER_MAKERS | _ALARMS
